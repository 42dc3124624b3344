#include "dashboard/dashboard_service.hpp"

int main(int argc, char** argv) {
  return lab::serviceMain(argc, argv, lab::dashboard::serviceDescription());
}
