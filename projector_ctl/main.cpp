#include "projector_ctl/projector_service.hpp"

int main(int argc, char** argv) {
  return lab::serviceMain(argc, argv, lab::projector::serviceDescription());
}
