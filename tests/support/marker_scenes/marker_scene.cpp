#include "tests/support/marker_scenes/marker_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <random>
#include <stdexcept>

#include "light/optics/simulated_camera.hpp"
#include "light/optics/tag_pattern.hpp"
#include "tracker_svc/plane_pose.hpp"

namespace lab::cases {
namespace {

constexpr int kParts = 10;            // of a pixel, along each side
constexpr double kHiddenPart = 0.75;  // [half axes] from the centre; beyond it a marker is hidden

/// The light at a place, of full light.
double lightAt(const MarkerSceneSettings& settings, double x, double y) {
  const double u = x / settings.arena_width;
  const double v = y / settings.arena_height;
  switch (settings.light) {
    case SceneLight::kEven:
      return 1;
    case SceneLight::kGradient:
      return std::clamp(0.15 + 0.85 * u, 0.1, 1.0);
    case SceneLight::kRadial:
      return 1 / (1 + 6 * ((u - 0.4) * (u - 0.4) + (v - 0.5) * (v - 0.5)));
    case SceneLight::kWaves:
      return 0.6 + 0.35 * std::sin(2 * std::numbers::pi * (x + 0.4 * y) / 0.35);
  }
  return 1;
}

/// Whether a point of the marker's own frame [m] is hidden.
bool isHidden(const TrueMarker& marker, double along) {
  return marker.hidden && along > kHiddenPart * marker.long_axis;
}

/// Albedo of a marker at a point of its own frame [m], negative outside it.
class MarkerLook {
 public:
  MarkerLook(const MarkerSceneSettings& settings, const TrueMarker& marker)
      : settings_(settings), marker_(marker) {
    if (marker.tag >= 0) {
      pattern_ = optics::TagFamily(settings.family).pattern(marker.tag);
      cell_ = marker.long_axis / pattern_.half_square;
    }
  }

  [[nodiscard]] double reach() const {
    return marker_.tag < 0 ? marker_.long_axis : pattern_.cells * cell_ / std::numbers::sqrt2;
  }

  [[nodiscard]] double albedo(double along, double up) const {
    if (marker_.tag < 0) {
      const double p = along / marker_.long_axis;
      const double q = up / marker_.short_axis;
      return p * p + q * q <= 1 && !isHidden(marker_, along) ? settings_.marker : -1;
    }
    const double column = along / cell_ + pattern_.cells / 2.0;
    const double row = -up / cell_ + pattern_.cells / 2.0;
    if (column < 0 || row < 0 || column >= pattern_.cells || row >= pattern_.cells) return -1;
    if (isHidden(marker_, along)) return settings_.ground;
    const bool dark = pattern_.at(static_cast<int>(column), static_cast<int>(row)) > 0.5F;
    return dark ? settings_.marker : settings_.white;
  }

 private:
  const MarkerSceneSettings& settings_;
  const TrueMarker& marker_;
  optics::TagPattern pattern_;
  double cell_ = 1;
};

void blurRows(std::vector<double>& picture, int width, int height, double blur) {
  const int reach = static_cast<int>(std::ceil(4 * blur));
  std::vector<double> taps;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    taps.push_back(std::exp(-0.5 * i * i / (blur * blur)));
    sum += taps.back();
  }
  std::vector<double> line(static_cast<std::size_t>(width));
  for (int y = 0; y < height; ++y) {
    double* row = &picture[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)];
    for (int x = 0; x < width; ++x) {
      double value = 0;
      for (int i = -reach; i <= reach; ++i) {
        value += taps[static_cast<std::size_t>(i + reach)] * row[std::clamp(x + i, 0, width - 1)];
      }
      line[static_cast<std::size_t>(x)] = value / sum;
    }
    std::copy(line.begin(), line.end(), row);
  }
}

std::vector<double> transposed(const std::vector<double>& picture, int width, int height) {
  std::vector<double> result(picture.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      result[static_cast<std::size_t>(x) * static_cast<std::size_t>(height) +
             static_cast<std::size_t>(y)] =
          picture[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
    }
  }
  return result;
}

void paintMarker(const MarkerSceneSettings& settings, const optics::CameraModel& camera,
                 const TrueMarker& marker, std::vector<double>& albedos) {
  const MarkerLook look(settings, marker);
  const optics::Pixel at = camera.project(marker.x, marker.y, settings.plane);
  const optics::PlaneScale scale = camera.scaleAt({marker.x, marker.y}, settings.plane);
  const double reach =
      look.reach() * std::max(std::hypot(scale.ux, scale.uy), std::hypot(scale.vx, scale.vy)) + 2;
  const double cosine = std::cos(marker.theta);
  const double sine = std::sin(marker.theta);
  const int left = std::max(0, static_cast<int>(at.x - reach));
  const int right = std::min(settings.width - 1, static_cast<int>(at.x + reach));
  const int top = std::max(0, static_cast<int>(at.y - reach));
  const int bottom = std::min(settings.height - 1, static_cast<int>(at.y + reach));
  for (int v = top; v <= bottom; ++v) {
    for (int u = left; u <= right; ++u) {
      const auto middle = detector::planePoint(
          camera, {static_cast<double>(u), static_cast<double>(v)}, settings.plane);
      if (!middle) continue;
      const optics::PlaneScale& s = middle->per_pixel;
      double& albedo =
          albedos[static_cast<std::size_t>(v) * static_cast<std::size_t>(settings.width) +
                  static_cast<std::size_t>(u)];
      double sum = 0;
      for (int j = 0; j < kParts; ++j) {
        for (int i = 0; i < kParts; ++i) {
          const double du = (i + 0.5) / kParts - 0.5;
          const double dv = (j + 0.5) / kParts - 0.5;
          const double x = middle->place.x + s.ux * du + s.uy * dv - marker.x;
          const double y = middle->place.y + s.vx * du + s.vy * dv - marker.y;
          const double here = look.albedo(cosine * x + sine * y, -sine * x + cosine * y);
          sum += here < 0 ? albedo : here;
        }
      }
      albedo = sum / (kParts * kParts);
    }
  }
}

}  // namespace

optics::CameraModel cameraOf(const MarkerSceneSettings& settings) {
  return optics::CameraModel(optics::simulatedCamera(settings.width, settings.height,
                                                     settings.arena_width, settings.arena_height));
}

optics::GreyImage paintMarkers(const MarkerSceneSettings& settings,
                               const std::vector<TrueMarker>& markers) {
  const optics::CameraModel camera = cameraOf(settings);
  const auto size =
      static_cast<std::size_t>(settings.width) * static_cast<std::size_t>(settings.height);
  std::vector<double> picture(size, settings.ground);
  for (const TrueMarker& marker : markers) paintMarker(settings, camera, marker, picture);
  // Light varies slowly, so it is computed once for four pixels.
  constexpr int kLightCell = 2;
  for (int v = 0; v < settings.height; v += kLightCell) {
    for (int u = 0; u < settings.width; u += kLightCell) {
      const auto place = camera.toPlane({u + 0.5, v + 0.5}, settings.plane);
      const double light = place ? lightAt(settings, place->x, place->y) : 0.5;
      for (int y = v; y < std::min(v + kLightCell, settings.height); ++y) {
        for (int x = u; x < std::min(u + kLightCell, settings.width); ++x) {
          picture[static_cast<std::size_t>(y) * static_cast<std::size_t>(settings.width) +
                  static_cast<std::size_t>(x)] *= light * settings.brightness;
        }
      }
    }
  }
  blurRows(picture, settings.width, settings.height, settings.imaging.blur);
  picture = transposed(picture, settings.width, settings.height);
  blurRows(picture, settings.height, settings.width, settings.imaging.blur);
  picture = transposed(picture, settings.height, settings.width);
  optics::GreyImage image(settings.width, settings.height);
  std::mt19937_64 random(settings.seed);
  std::normal_distribution<double> normal;
  const double read = settings.imaging.read_noise * settings.imaging.read_noise;
  for (std::size_t i = 0; i < size; ++i) {
    const double noise = std::sqrt(read + settings.imaging.shot_gain * picture[i]);
    const double grey = picture[i] + settings.imaging.black + noise * normal(random);
    image.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
  }
  return image;
}

std::vector<MarkerKind> markerKinds() {
  std::vector<MarkerKind> kinds;
  const auto add = [&](const char* name, const auto& change) {
    MarkerKind kind;
    kind.name = name;
    kind.tags = kind.name.starts_with("tags_");
    if (kind.tags) {
      kind.long_axis = kind.short_axis = 0.02;
      kind.spread = 0;
      kind.settings.plane = 0.05;
    }
    change(kind);
    kinds.push_back(kind);
  };
  const auto axes = [](MarkerKind& kind, double long_axis, double short_axis) {
    kind.long_axis = long_axis;
    kind.short_axis = short_axis;
  };
  add("blobs_clean", [](MarkerKind&) {});
  add("blobs_small", [&](MarkerKind& kind) {
    axes(kind, 0.004, 0.004);
    kind.count = 60;
  });
  add("blobs_bright", [](MarkerKind& kind) {
    kind.bright = true;
    kind.settings.ground = 0.08;
    kind.settings.marker = 0.8;
  });
  add("blobs_gradient", [](MarkerKind& kind) { kind.settings.light = SceneLight::kGradient; });
  add("blobs_radial", [](MarkerKind& kind) { kind.settings.light = SceneLight::kRadial; });
  add("blobs_waves", [](MarkerKind& kind) { kind.settings.light = SceneLight::kWaves; });
  add("blobs_dim", [](MarkerKind& kind) { kind.settings.brightness = 25; });
  add("blobs_grey", [](MarkerKind& kind) { kind.settings.marker = 0.5; });
  add("blobs_defocus", [](MarkerKind& kind) { kind.settings.imaging.blur = 2.5; });
  add("blobs_contact", [](MarkerKind& kind) { kind.chain = 2; });
  add("blobs_chains", [](MarkerKind& kind) {
    kind.chain = 4;
    kind.count = 40;
  });
  add("blobs_hidden", [](MarkerKind& kind) { kind.hidden = 0.2; });
  add("blobs_animals", [&](MarkerKind& kind) {
    axes(kind, 0.012, 0.005);
    kind.spread = 0.1;
  });
  add("blobs_animals_contact", [&](MarkerKind& kind) {
    axes(kind, 0.012, 0.005);
    kind.chain = 2;
  });
  add("blobs_worst", [](MarkerKind& kind) {
    kind.settings.light = SceneLight::kGradient;
    kind.settings.imaging.blur = 1.8;
    kind.chain = 2;
    kind.count = 50;
  });
  add("tags_clean", [](MarkerKind&) {});
  add("tags_small", [&](MarkerKind& kind) { axes(kind, 0.0125, 0.0125); });
  add("tags_gradient", [](MarkerKind& kind) { kind.settings.light = SceneLight::kGradient; });
  add("tags_waves", [](MarkerKind& kind) { kind.settings.light = SceneLight::kWaves; });
  add("tags_dim", [](MarkerKind& kind) { kind.settings.brightness = 40; });
  add("tags_defocus", [](MarkerKind& kind) { kind.settings.imaging.blur = 1.5; });
  add("tags_contact", [](MarkerKind& kind) { kind.chain = 2; });
  add("tags_hidden", [](MarkerKind& kind) { kind.hidden = 0.2; });
  add("tags_standard41", [](MarkerKind& kind) { kind.settings.family = "tagStandard41h12"; });
  return kinds;
}

MarkerKind markerKind(std::string_view name) {
  for (MarkerKind& kind : markerKinds()) {
    if (kind.name == name) return kind;
  }
  throw std::invalid_argument("no kind of scene " + std::string(name));
}

std::vector<TrueMarker> placeMarkers(const MarkerKind& kind, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  std::normal_distribution<double> normal;
  // A tag with its margin; blobs with a gap that keeps blurred edges apart.
  constexpr double kGap = 0.012;  // [m]
  const double tag_reach = [&] {
    if (!kind.tags) return 0.0;
    const optics::TagPattern pattern = optics::TagFamily(kind.settings.family).pattern(0);
    return kind.long_axis * pattern.cells / 2.0 / pattern.half_square;
  }();
  const double reach = kind.tags ? std::numbers::sqrt2 * tag_reach : kind.long_axis;
  const double border = reach + 0.01;
  std::vector<TrueMarker> markers;
  int tag = 0;
  bool is_chain = true;
  while (static_cast<int>(markers.size()) < kind.count) {
    std::vector<TrueMarker> chain;
    const double way = 2 * std::numbers::pi * share(random);
    double x = border + share(random) * (kind.settings.arena_width - 2 * border);
    double y = border + share(random) * (kind.settings.arena_height - 2 * border);
    // Every second group is a single marker, which shows how large one is.
    const int length = is_chain || kind.tags ? kind.chain : 1;
    for (int i = 0; i < length; ++i) {
      TrueMarker one;
      const double size = 1 + kind.spread * normal(random);
      one.long_axis = kind.long_axis * size;
      one.short_axis = kind.short_axis * size;
      one.theta = 2 * std::numbers::pi * (share(random) - 0.5);
      one.hidden = share(random) < kind.hidden;
      if (kind.tags) {
        one.tag = tag + i;
        one.theta = way;  // side by side
        if (i > 0) {
          x += 2 * tag_reach * std::cos(way);
          y += 2 * tag_reach * std::sin(way);
        }
      } else if (i > 0) {
        // Ellipses touch with the short axis across the chain.
        const bool is_long = kind.long_axis > 1.2 * kind.short_axis;
        if (is_long) one.theta = chain.back().theta + 0.4 * (share(random) - 0.5);
        const double turn =
            is_long ? chain.back().theta + std::numbers::pi / 2 : way + 1.2 * (share(random) - 0.5);
        const double apart = (chain.back().short_axis + one.short_axis) * (is_long ? 1.08 : 1.005);
        x += apart * std::cos(turn);
        y += apart * std::sin(turn);
      }
      one.x = x;
      one.y = y;
      chain.push_back(one);
    }
    const bool free = std::all_of(chain.begin(), chain.end(), [&](const TrueMarker& one) {
      if (one.x < border || one.y < border || one.x > kind.settings.arena_width - border ||
          one.y > kind.settings.arena_height - border) {
        return false;
      }
      const bool alone = std::all_of(markers.begin(), markers.end(), [&](const TrueMarker& other) {
        return std::hypot(one.x - other.x, one.y - other.y) > 2 * reach + kGap;
      });
      return alone && std::all_of(chain.begin(), chain.end(), [&](const TrueMarker& other) {
               const double apart = std::hypot(one.x - other.x, one.y - other.y);
               return &one == &other || kind.tags || apart > 1.99 * kind.short_axis * 0.85;
             });
    });
    if (!free) continue;
    markers.insert(markers.end(), chain.begin(), chain.end());
    tag += kind.chain;
    is_chain = !is_chain;
  }
  markers.resize(static_cast<std::size_t>(kind.count));
  return markers;
}

}  // namespace lab::cases
