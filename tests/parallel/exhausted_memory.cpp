// A process of MPI without memory for the message of another one: all processes have the same error, and none
// waits.
#include <mpi.h>

#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>

#include <pcor/mpi/mpi_communicator.hpp>

namespace {

constexpr std::size_t message = std::size_t{1} << 20;  // bytes
bool is_exhausted = false;

}  // namespace

void* operator new(std::size_t bytes) {
  void* const memory = is_exhausted && bytes >= message ? nullptr : std::malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  bool is_agreed = false;
  {
    pcor::MpiCommunicator comm;
    is_exhausted = comm.rank() == 1;
    try {
      comm.all_gather(comm.rank() == 0 ? std::string(message, 'x') : "");
    } catch (const std::bad_alloc&) {
      const auto error = comm.finalize(pcor::Error(pcor::Error::Code::system, "no memory"));
      is_agreed = error && std::string(error->what()) == "no memory";
    }
    if (!is_agreed) std::fprintf(stderr, "process %zu does not have the error\n", comm.rank());
    is_exhausted = false;
  }
  MPI_Finalize();
  return is_agreed ? 0 : 1;
}
