/// Conversion of the light field to messages and back.
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

/// Sets the command's layers and drives.
void setLayers(light_command_t& command, const std::vector<light::DrivenLayer>& layers);

/// The layers of a command and their drives, with the pixels of the images that are in `images`. A
/// drive without a layer is left out.
[[nodiscard]] std::vector<light::DrivenLayer> toDrivenLayers(const light_command_t& command,
                                                             const light::ImageStore& images = {});

[[nodiscard]] std::vector<light_layer_t> toMessages(const std::vector<light::Layer>& layers);

/// The layers of a message, with the pixels of the images that are in `images`. They are not
/// checked; light::validate() does that.
[[nodiscard]] std::vector<light::Layer> toLayers(const std::vector<light_layer_t>& layers,
                                                 const light::ImageStore& images = {});

/// The field of these layers.
[[nodiscard]] light::Field toField(const std::vector<light_layer_t>& layers,
                                   const light::ImageStore& images = {});

/// The field on the arena according to a status.
[[nodiscard]] light::Field toField(const light_status_t& status,
                                   const light::ImageStore& images = {});

/// The text of `last_refusal` in LIGHT_STATUS.
[[nodiscard]] std::string formatRefusal(const std::string& sender, std::int64_t seq,
                                        const std::string& reason);

/// Why the command (sender, seq) was refused, from `last_refusal`; empty if that is of another
/// command or empty.
[[nodiscard]] std::string parseRefusal(const std::string& sender, std::int64_t seq,
                                       const std::string& last_refusal);

/// The images of an experiment's light script.
struct ExperimentImages {
  light::ImageStore store;                     ///< by SHA-256
  std::map<std::string, std::string> digests;  ///< SHA-256 by the path written in the file
};

/// The layers of an experiment, with the digests and pixels of their images.
[[nodiscard]] std::vector<light::DrivenLayer> toDrivenLayers(const std::vector<LayerSpec>& layers,
                                                             const ExperimentImages& images);

/// Loads the images of an experiment.
/// @param directory of the experiment file, which paths are relative to
/// @throws std::runtime_error that names an image that cannot be read
[[nodiscard]] ExperimentImages loadImages(const Experiment& experiment,
                                          const std::filesystem::path& directory);

}  // namespace lab
