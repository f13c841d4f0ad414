#include "communicator.hpp"

namespace pcor::tool {
namespace {

Communicator*& communicator_of_run() {
  static Communicator* comm = &serial_communicator();
  return comm;
}

}  // namespace

Communicator& comm() { return *communicator_of_run(); }

void set_communicator(Communicator& comm) { communicator_of_run() = &comm; }

bool is_speaker() { return comm().rank() == 0; }

}  // namespace pcor::tool
