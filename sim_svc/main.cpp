#include "sim_svc/sim_service.hpp"

int main(int argc, char** argv) {
  return lab::serviceMain(argc, argv, lab::sim::serviceDescription());
}
