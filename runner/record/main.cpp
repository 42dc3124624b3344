#include "runner/record/recorder_service.hpp"

int main(int argc, char** argv) {
  return lab::serviceMain(argc, argv, lab::runner::recorderDescription());
}
