#include "tracker_svc/tracker_service.hpp"

int main(int argc, char** argv) {
  return lab::serviceMain(argc, argv, lab::tracker::serviceDescription());
}
