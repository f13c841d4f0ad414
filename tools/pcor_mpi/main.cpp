#include <mpi.h>

#include <pcor/mpi/mpi_communicator.hpp>
#include "program.hpp"
#include "text.hpp"

/// Runs pcor on all processes started by mpirun, srun or the like.
int main(int argc, char** argv) {
  // Only the main thread of the program calls MPI.
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  pcor::MpiCommunicator comm;
  pcor::tool::disable_terminal_style();
  const pcor::tool::Ending ending = pcor::tool::run_program(argc, argv, comm);
  MPI_Finalize();
  pcor::tool::end_process(ending);
}
