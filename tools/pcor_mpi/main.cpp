#include <mpi.h>

#include <pcor/mpi/mpi_communicator.hpp>
#include "program.hpp"
#include "text.hpp"

/// As pcor, on all processes that mpirun, srun or the like has begun.
int main(int argc, char** argv) {
  // Threads of the program do not talk to other processes; its first one does.
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  pcor::MpiCommunicator comm;
  pcor::tool::say_plainly();
  const pcor::tool::Ending ending = pcor::tool::run_program(argc, argv, comm);
  MPI_Finalize();
  pcor::tool::end_process(ending);
}
