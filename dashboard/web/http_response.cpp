#include "dashboard/web/http_response.hpp"

#include <array>
#include <utility>

#include "dashboard/web/json.hpp"

namespace lab::dashboard {

HttpResponse emptyResponse() {
  HttpResponse response;
  response.headers = {
      {"Content-Security-Policy",
       "default-src 'self'; img-src 'self' data: blob:; media-src 'self' blob:; style-src 'self' "
       "'unsafe-inline'; "
       "object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"X-Frame-Options", "DENY"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cross-Origin-Opener-Policy", "same-origin"},
      {"Cache-Control", "no-store"},
  };
  return response;
}

void respondJson(HttpResponse& response, std::string text, int status) {
  response.status = status;
  response.setBody("application/json", std::move(text));
}

void respondError(HttpResponse& response, int status, std::string_view why) {
  respondJson(response, toText({{"error", why}}), status);
}

std::string contentType(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, const char*>, 13> kTypes{{
      {".html", "text/html; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".json", "application/json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".mp4", "video/mp4"},
      {".ico", "image/x-icon"},
      {".csv", "text/csv; charset=utf-8"},
      {".toml", "text/plain; charset=utf-8"},
      {".txt", "text/plain; charset=utf-8"},
      {".pdf", "application/pdf"},
  }};
  for (const auto& [ending, type] : kTypes) {
    if (name.ends_with(ending)) return type;
  }
  return "application/octet-stream";
}

}  // namespace lab::dashboard
