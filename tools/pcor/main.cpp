#include "program.hpp"

int main(int argc, char** argv) {
  pcor::tool::end_process(pcor::tool::run_program(argc, argv, pcor::serial_communicator()));
}
