#include "dds_gateway/gateway_service.hpp"

int main(int argc, char** argv) {
  return lab::serviceMain(argc, argv, lab::gateway::serviceDescription());
}
