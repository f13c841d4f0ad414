#include <pcor/parallel/fork_communicator.hpp>

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <new>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>

namespace pcor {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Runs processes as a team. @return result of the first process, as text
///
/// Every process holds the end of a pipe, so the text ends when all have ended; otherwise the test would wait
/// until its time limit.
std::string by_team(std::size_t size, const std::function<std::string(Communicator&)>& work) {
  int ends[2];
  if (::pipe(ends) != 0) return "no pipe";
  const pid_t process = ::fork();
  if (process == 0) {
    std::string text;
    {
      ForkCommunicator comm(size);
      try {
        text = work(comm);
      } catch (const Error& error) {
        // As a program does: the last words to the others, who may be gone.
        const Error last = comm.leave(error).value_or(error);
        text = std::string(to_string(last.code())) + ": " + last.what();
      } catch (const std::bad_alloc&) {
        comm.leave(Error(Error::Code::system, "no memory"));
      }
      if (comm.rank() > 0) text.clear();
    }
    [[maybe_unused]] const auto written = ::write(ends[1], text.data(), text.size());
    ::_exit(0);
  }
  ::close(ends[1]);
  std::string found;
  char some[4096];
  for (ssize_t count = 0; (count = ::read(ends[0], some, sizeof some)) > 0;)
    found.append(some, static_cast<std::size_t>(count));
  ::close(ends[0]);
  ::waitpid(process, nullptr, 0);
  return found;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += "<" + part + ">";
  return text;
}

TEST(ForkCommunicator, AllMembersGatherAllParts) {
  const auto work = [](Communicator& comm) {
    const std::string own = joined(comm.gather(std::string(comm.rank(), 'x')));
    return joined(comm.gather(own + std::string("\0", 1)));
  };
  const std::string each = "<<><x><xx>" + std::string("\0", 1) + ">";
  EXPECT_EQ(by_team(3, work), each + each + each);
  EXPECT_EQ(by_team(1, work), "<<>" + std::string("\0", 1) + ">");
}

TEST(ForkCommunicator, PartsLargerThanTheSocketBufferAreGathered) {
  constexpr std::size_t count = 5'000'000;
  const auto work = [](Communicator& comm) {
    const std::string own(count + comm.rank(), static_cast<char>('a' + comm.rank()));
    std::string found;
    for (const std::string& part : comm.gather(own)) {
      const bool is_whole = part == std::string(part.size(), part.front());
      found += part.front() + std::to_string(part.size()) + (is_whole ? " " : "! ");
    }
    return joined(comm.gather(found));
  };
  const std::string found = "<a5000000 b5000001 c5000002 d5000003 >";
  EXPECT_EQ(by_team(4, work), found + found + found + found);
}

TEST(ForkCommunicator, KilledMemberIsAnError) {
  const auto work = [](Communicator& comm) {
    if (comm.rank() == 2) ::raise(SIGKILL);
    return joined(comm.gather("part"));
  };
  EXPECT_THAT(by_team(3, work), AllOf(StartsWith("system: "), HasSubstr("3 processes")));
}

TEST(ForkCommunicator, ReportedFailureIsNotRepeated) {
  const auto ends_with = [](int status) {
    return by_team(3, [status](Communicator& comm) {
      if (comm.rank() == 1) ::_exit(status);
      return joined(comm.gather("part"));
    });
  };
  EXPECT_EQ(ends_with(ForkCommunicator::has_told), "system: ");
  for (const int status : {0, 1})
    EXPECT_THAT(ends_with(status), AllOf(StartsWith("system: "), HasSubstr("3 processes"))) << status;
}

TEST(ForkCommunicator, LostMemberEndsWaitingMembers) {
  const auto work = [](Communicator& comm) {
    if (comm.rank() == 1)
      while (true) ::pause();
    if (comm.rank() == 2) ::raise(SIGUSR1);
    return joined(comm.gather("part"));
  };
  EXPECT_THAT(by_team(3, work), AllOf(StartsWith("system: "), HasSubstr("User defined signal 1")));
}

TEST(ForkCommunicator, OutOfMemoryMemberIsAnError) {
  const auto work = [](Communicator& comm) {
    if (comm.rank() == 1) {
      const rlimit little{std::size_t{64} << 20U, std::size_t{64} << 20U};
      ::setrlimit(RLIMIT_AS, &little);
    }
    return std::to_string(
        comm.gather(comm.rank() == 0 ? std::string(std::size_t{80} << 20U, 'x') : "").size());
  };
  EXPECT_THAT(by_team(3, work), AllOf(StartsWith("system: "), HasSubstr("3 processes")));
}

TEST(ForkCommunicator, EndOfTheFirstMemberEndsAll) {
  const auto work = [](Communicator& comm) {
    comm.gather("");
    if (comm.rank() == 0) ::raise(SIGKILL);
    while (true) ::pause();
    return std::string("never");
  };
  EXPECT_EQ(by_team(3, work), "");
}

}  // namespace
}  // namespace pcor
