#include <fcntl.h>
#include <mpi.h>
#include <unistd.h>

#include <pcor/mpi/mpi_team.hpp>
#include "program.hpp"
#include "text.hpp"

namespace {

/// Where the first process of the team prints for all.
void print_nothing() {
  const int nowhere = open("/dev/null", O_WRONLY);
  if (nowhere < 0) return;
  dup2(nowhere, STDOUT_FILENO);
  close(nowhere);
}

}  // namespace

/// As pcor, on all processes that mpirun, srun or the like has begun.
int main(int argc, char** argv) {
  // Threads of the program do not talk to other processes; its first one does.
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  pcor::MpiTeam team;
  if (team.rank() > 0) print_nothing();
  pcor::tool::say_plainly();
  const pcor::tool::Ending ending = pcor::tool::run_program(argc, argv, team);
  MPI_Finalize();
  pcor::tool::end_process(ending);
}
