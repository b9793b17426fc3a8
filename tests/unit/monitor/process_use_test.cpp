// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/process_use.hpp"

#include "monitor/app/api.hpp"
#include "monitor/app/metrics.hpp"

#include <csignal>
#include <fstream>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace::monitor {
namespace {

using std::chrono::seconds;
using std::chrono::steady_clock;
using testing::HasSubstr;
using testing::Not;

/// A child that waits until it is killed.
class Child {
  public:
    Child() : pid_{::fork()} {
        if (pid_ == 0) {
            ::pause();
            ::_exit(0);
        }
    }
    ~Child() { end(); }
    Child(Child const&) = delete;
    Child& operator=(Child const&) = delete;
    [[nodiscard]] pid_t pid() const { return pid_; }
    void end() {
        if (pid_ > 0) {
            ::kill(pid_, SIGKILL);
            ::waitpid(std::exchange(pid_, 0), nullptr, 0);
        }
    }

  private:
    pid_t pid_;
};

class ProcessUsesTest : public testing::Test {
  protected:
    ProcessUsesTest() {
        for (char const* name : {"us", "child", "board", "to_come"}) {
            RunPlan::Process process;
            process.name = name;
            process.pid_file = std::string{name} == "board" ? std::filesystem::path{} : file(name);
            plan_.processes.push_back(process);
        }
    }
    ~ProcessUsesTest() override {
        for (char const* name : {"us", "child", "to_come"}) {
            std::filesystem::remove(file(name));
        }
    }
    static std::filesystem::path file(std::string const& name) {
        return std::filesystem::path{testing::TempDir()} / (name + std::to_string(::getpid()) + ".pid");
    }
    static void note(std::string const& name, pid_t pid) { std::ofstream{file(name)} << pid << '\n'; }

    RunPlan plan_;
};

TEST_F(ProcessUsesTest, SaysWhatIsUsedByThoseWhoseIdentifierIsNotedAndNothingOfOthers) {
    LiveRun live{plan_};
    ProcessUses sut{plan_};
    Child child;
    note("us", ::getpid());
    note("child", child.pid());
    auto const begin = steady_clock::now();
    sut.follow(live, begin);
    EXPECT_THAT(live.use, testing::UnorderedElementsAre(testing::Key("us"), testing::Key("child")));
    EXPECT_FALSE(live.use["us"].cpu_percent.has_value()); // of what time?
    double const before_s = live.use["us"].cpu_s;
    for (volatile int i = 0; *processor_s_of(::getpid()) < before_s + 0.05;) {
        i = i + 1;
    }
    sut.follow(live, begin + seconds{1});
    EXPECT_GE(live.use["us"].cpu_percent.value(), 5);
    EXPECT_LT(live.use["child"].cpu_percent.value(), 5); // it waits
    EXPECT_GT(live.use["us"].memory_octets.value_or(1U << 20), 1U << 19);
    EXPECT_LT(live.use["us"].memory_octets.value_or(1U << 20), std::uint64_t{1} << 34);
}

TEST_F(ProcessUsesTest, ForgetsWhoHasGoneAndBeginsAnewWithTheNextIncarnation) {
    LiveRun live{plan_};
    ProcessUses sut{plan_};
    Child first, second;
    note("child", first.pid());
    auto const begin = steady_clock::now();
    sut.follow(live, begin);
    EXPECT_TRUE(live.use.contains("child"));
    first.end();
    sut.follow(live, begin + seconds{1});
    EXPECT_FALSE(live.use.contains("child"));
    note("child", second.pid());
    sut.follow(live, begin + seconds{2});
    ASSERT_TRUE(live.use.contains("child"));
    EXPECT_FALSE(live.use["child"].cpu_percent.has_value());
}

TEST_F(ProcessUsesTest, LooksOnceASecond) {
    LiveRun live{plan_};
    ProcessUses sut{plan_};
    auto const begin = steady_clock::now();
    sut.follow(live, begin);
    note("us", ::getpid());
    sut.follow(live, begin + std::chrono::milliseconds{900});
    EXPECT_TRUE(live.use.empty());
    sut.follow(live, begin + seconds{1});
    EXPECT_TRUE(live.use.contains("us"));
}

TEST_F(ProcessUsesTest, TakesNoNoteThatIsNone) {
    LiveRun live{plan_};
    for (char const* text : {"", "abc\n", "-1\n", "0\n", "99999999999999999999\n"}) {
        std::ofstream{file("us")} << text;
        ProcessUses sut{plan_};
        sut.follow(live, steady_clock::now());
        EXPECT_TRUE(live.use.empty()) << text;
    }
}

TEST_F(ProcessUsesTest, IsToldByTheInterfaceAndLeftOutWhereItIsNotKnown) {
    LiveRun live{plan_};
    live.use["us"] = {1.5, 12.345, 2048};
    live.use["child"] = {0.25, std::nullopt, std::nullopt};
    Api const api{live, [] { return web::ServerCounters{}; }};
    for (std::string const& text : {api.health(), api.run()}) {
        for (auto const& process : nlohmann::json::parse(text)["processes"]) {
            std::string const name = process["name"];
            EXPECT_EQ(process.contains("cpu_s"), name == "us" || name == "child") << text;
            EXPECT_EQ(process.contains("cpu_percent"), name == "us") << text;
            EXPECT_EQ(process.contains("memory_octets"), name == "us") << text;
            if (name == "us") {
                EXPECT_DOUBLE_EQ(process["cpu_percent"].get<double>(), 12.3);
            }
        }
    }
    std::string const metrics = metrics_text(live, {});
    EXPECT_THAT(metrics, HasSubstr("gridspace_process_cpu_seconds_total{process=\"us\"} 1.5\n"));
    EXPECT_THAT(metrics, HasSubstr("gridspace_process_resident_memory_bytes{process=\"us\"} 2048\n"));
    EXPECT_THAT(metrics, Not(HasSubstr("cpu_seconds_total{process=\"board\"}")));
    EXPECT_THAT(metrics, Not(HasSubstr("resident_memory_bytes{process=\"child\"}")));
}

} // namespace
} // namespace gridspace::monitor
