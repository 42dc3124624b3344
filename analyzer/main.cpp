#include "analyzer/analyzer_service.hpp"

int main(int argc, char** argv) {
  return lab::serviceMain(argc, argv, lab::analysis::serviceDescription());
}
