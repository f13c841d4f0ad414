#pragma once

#include <pcor/parallel/communicator.hpp>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace pcor::test {

/// Runs `work` in `size` threads that exchange messages. A thread that waits longer than a minute for the
/// others fails, because the program would hang.
/// @param one_at_a_time only one thread works at a time, as the netCDF library requires
/// @return bytes that each thread sent in each exchange
/// @throws an exception of `work`, after all threads have ended
inline std::vector<std::vector<std::size_t>> run_with_communicator(
    std::size_t size, const std::function<void(Communicator&)>& work, bool one_at_a_time = false) {
  struct Table {
    std::mutex working{};  // held by the working thread if one_at_a_time
    std::mutex mutex{};
    std::condition_variable changed{};
    std::vector<std::string> laid{};
    std::size_t count = 0;
    std::size_t round = 0;
    std::vector<std::string> all{};
  } table;
  table.laid.resize(size);

  class ThreadRank final : public Communicator {
   public:
    ThreadRank(Table& table, std::size_t rank, std::size_t size, bool one_at_a_time)
        : table_(table), rank_(rank), size_(size), one_at_a_time_(one_at_a_time) {}
    std::size_t rank() const override { return rank_; }
    std::size_t size() const override { return size_; }

    std::vector<std::size_t> sent{};

   private:
    std::vector<std::string> exchange(const std::string& local) override {
      sent.push_back(local.size());
      if (one_at_a_time_) table_.working.unlock();
      std::vector<std::string> all = exchange_with_others(local);
      if (one_at_a_time_) table_.working.lock();
      return all;
    }

    std::vector<std::string> exchange_with_others(const std::string& local) {
      std::unique_lock lock(table_.mutex);
      const std::size_t round = table_.round;
      table_.laid[rank_] = local;
      if (++table_.count == size_) {
        table_.all = table_.laid;
        table_.count = 0;
        ++table_.round;
        table_.changed.notify_all();
      } else if (!table_.changed.wait_for(lock, std::chrono::minutes(1),
                                          [&] { return table_.round != round; })) {
        throw std::logic_error("a thread waited more than 1 min for an exchange");
      }
      return table_.all;
    }

    Table& table_;
    std::size_t rank_;
    std::size_t size_;
    bool one_at_a_time_;
  };

  std::vector<std::unique_ptr<ThreadRank>> ranks;
  std::vector<std::exception_ptr> thrown(size);
  std::vector<std::thread> threads;
  for (std::size_t rank = 0; rank < size; ++rank)
    ranks.push_back(std::make_unique<ThreadRank>(table, rank, size, one_at_a_time));
  for (std::size_t rank = 0; rank < size; ++rank) {
    threads.emplace_back([&, rank] {
      if (one_at_a_time) table.working.lock();
      try {
        work(*ranks[rank]);
      } catch (...) {
        thrown[rank] = std::current_exception();
      }
      if (one_at_a_time) table.working.unlock();
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& each : thrown) {
    if (each) std::rethrow_exception(each);
  }
  std::vector<std::vector<std::size_t>> sent;
  for (const std::unique_ptr<ThreadRank>& rank : ranks) sent.push_back(rank->sent);
  return sent;
}

}  // namespace pcor::test
