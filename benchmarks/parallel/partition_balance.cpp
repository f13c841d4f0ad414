#include <mpi.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <random>
#include <thread>

#include <pcor/mpi/mpi_communicator.hpp>
#include "parallel/flight_partition.hpp"

// Measures the distribution of flights over processes and the cost of the exchange. Each flight is replaced
// by a sleep, 20 ms for the median length, so processors and file systems have no influence. Prints the time
// of a pass and the efficiency: ideal time / measured time.
//
//   mpirun -n 32 partition_balance [FLIGHTS_PER_PROCESS] [PASSES]      defaults 32 and 5
int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    pcor::MpiCommunicator comm;
    const std::size_t flights = (argc > 1 ? std::stoul(argv[1]) : 32) * comm.size();
    const int passes = argc > 2 ? std::stoi(argv[2]) : 5;
    std::mt19937 chance(1);
    std::lognormal_distribution<double> length(0.0, 0.35);  // relative to the median; 9 % exceed 1.6
    std::vector<std::uint64_t> microseconds;
    double all = 0.0;
    for (std::size_t flight = 0; flight < flights; ++flight) {
      microseconds.push_back(static_cast<std::uint64_t>(20'000.0 * length(chance)));
      all += 1e-6 * static_cast<double>(microseconds.back());
    }
    const pcor::FlightPartition partition(comm, microseconds);
    MPI_Barrier(MPI_COMM_WORLD);
    const auto begin = std::chrono::steady_clock::now();
    for (int pass = 0; pass < passes; ++pass) {
      partition.all_gather_flights<std::array<double, 55>>([&](std::size_t flight) {
        std::this_thread::sleep_for(std::chrono::microseconds(microseconds[flight]));
        return std::array<double, 55>{};
      });
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const double ideal = passes * all / static_cast<double>(comm.size());
    if (comm.rank() == 0)
      std::printf("%zu processes, %zu flights: %.3f s per pass, efficiency %.3f\n", comm.size(), flights,
                  seconds / passes, ideal / seconds);
  }
  MPI_Finalize();
}
