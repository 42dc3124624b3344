#include "common/http/http_server.hpp"

#include <exception>
#include <utility>

namespace lab {

int statusOf(RequestFault fault) {
  switch (fault) {
    case RequestFault::kMalformed:
      return 400;
    case RequestFault::kTooLarge:
      return 431;
    case RequestFault::kNoPlace:
      return 503;
  }
  return 500;
}

void HttpServer::open(Handler handler, FaultHandler fault_handler) {
  handler_ = std::move(handler);
  fault_handler_ = std::move(fault_handler);
  acceptor_.open([this](int socket, bool has_place) { serve(socket, has_place); });
}

void HttpServer::close() {
  closing_ = true;
  acceptor_.close();
}

void HttpServer::serve(int socket, bool has_place) {
  using Result = HttpExchange::Result;
  try {
    ClientStream stream(socket);
    HttpExchange exchange(stream);
    if (!has_place) {
      exchange.respond(fault_handler_(RequestFault::kNoPlace));
    } else if (const Result result = exchange.readHead(); result == Result::kOk) {
      try {
        handler_(exchange);
      } catch (const std::exception&) {
        if (!stream.hasWritten()) exchange.respond({.status = 500});
      }
    } else if (result != Result::kNoRequest && !closing_) {
      exchange.respond(fault_handler_(result == Result::kTooLarge ? RequestFault::kTooLarge
                                                                  : RequestFault::kMalformed));
    }
    if (stream.hasWritten()) stream.finish();
  } catch (const std::exception&) {
    // E.g. no memory is left: this connection ends, the others go on.
  }
}

}  // namespace lab
