/// The light field as messages and back.
#pragma once

#include <cstdint>
#include <filesystem>
#include <lab/light_command_t.hpp>
#include <lab/light_drive_t.hpp>
#include <lab/light_layer_t.hpp>
#include <lab/light_status_t.hpp>
#include <map>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "light/field/drive.hpp"
#include "light/field/field.hpp"
#include "light/field/image.hpp"

namespace lab {

/// A layer as written in an experiment file. An image layer comes without its pixels and its
/// SHA-256: loadImages() adds them.
[[nodiscard]] light::Layer toLightLayer(const LayerSpec& layer);

[[nodiscard]] light_layer_t toMessage(const light::Layer& layer);
[[nodiscard]] light_drive_t toMessage(const light::Drive& drive, std::int32_t layer);

/// Fills in the command's layers and drives.
void setLayers(light_command_t& command, const std::vector<light::DrivenLayer>& layers);

/// The layers of a command with what drives them, with the pixels of those images that are in
/// `images`. A drive of a layer that is not there is left out.
[[nodiscard]] std::vector<light::DrivenLayer> toDrivenLayers(const light_command_t& command,
                                                             const light::ImageStore& images = {});

[[nodiscard]] std::vector<light_layer_t> toMessages(const std::vector<light::Layer>& layers);

/// The layers of a message, with the pixels of those images that are in `images`. What arrives is
/// not checked: light::validate() says whether it can be painted.
[[nodiscard]] std::vector<light::Layer> toLayers(const std::vector<light_layer_t>& layers,
                                                 const light::ImageStore& images = {});

/// The field that shows these layers and nothing else.
[[nodiscard]] light::Field toField(const std::vector<light_layer_t>& layers,
                                   const light::ImageStore& images = {});

/// The field on the arena, as its status says.
[[nodiscard]] light::Field toField(const light_status_t& status,
                                   const light::ImageStore& images = {});

/// How LIGHT_STATUS says that a command was refused, in `last_refusal`.
[[nodiscard]] std::string formatRefusal(const std::string& sender, std::int64_t seq,
                                        const std::string& reason);

/// Why the command (sender, seq) was refused, by `last_refusal`; empty: that is of another command,
/// or there was none.
[[nodiscard]] std::string parseRefusal(const std::string& sender, std::int64_t seq,
                                       const std::string& last_refusal);

/// The images that an experiment's light script names.
struct ExperimentImages {
  light::ImageStore store;                     ///< by SHA-256
  std::map<std::string, std::string> digests;  ///< SHA-256 by the path written in the file
};

/// The layers of an experiment, with the digests and pixels of their images.
[[nodiscard]] std::vector<light::DrivenLayer> toDrivenLayers(const std::vector<LayerSpec>& layers,
                                                             const ExperimentImages& images);

/// Loads them from `directory`, where the experiment file lies.
/// @throws std::runtime_error for one that cannot be read, naming its path.
[[nodiscard]] ExperimentImages loadImages(const Experiment& experiment,
                                          const std::filesystem::path& directory);

}  // namespace lab
