/// Contents and headers that the responses of the web server share.
#pragma once

#include <string>
#include <string_view>

#include "common/http/http_message.hpp"

namespace lab::dashboard {

/// A response with status 200 and the security headers: the browser loads nothing from other sites,
/// does not let other sites frame the page, does not guess content types and does not cache.
[[nodiscard]] HttpResponse emptyResponse();

void respondJson(HttpResponse& response, std::string text, int status = 200);

/// Responds with {"error": why}.
void respondError(HttpResponse& response, int status, std::string_view why);

/// The content type by the file name's extension; "application/octet-stream" for unknown ones.
[[nodiscard]] std::string contentType(std::string_view name);

}  // namespace lab::dashboard
