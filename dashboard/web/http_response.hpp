/// Answers of the web server, with what every one of them says to the browser.
#pragma once

#include <httplib.h>

#include <string>
#include <string_view>

namespace lab::dashboard {

/// Of every answer: nothing is taken from elsewhere, framed elsewhere, guessed or kept.
[[nodiscard]] httplib::Headers commonHeaders();

/// Instead of the common one of that name.
void replaceHeader(httplib::Response& response, const std::string& name, const std::string& value);

void respondJson(httplib::Response& response, std::string text, int status = 200);

/// {"error": why}
void respondError(httplib::Response& response, int status, std::string_view why);

/// By its ending; for what has none of the known, bytes.
[[nodiscard]] std::string contentType(std::string_view name);

}  // namespace lab::dashboard
