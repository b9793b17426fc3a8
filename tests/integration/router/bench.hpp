// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/raw_access.hpp"
#include "router/router.hpp"

#include <condition_variable>
#include <gtest/gtest.h>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace gridspace::router {

inline constexpr std::chrono::seconds kHang{60}; ///< nothing that works takes that long

/// What a test waits for: nothing sleeps.
class Signal {
  public:
    void notify() {
        std::lock_guard const lock{mutex_};
        changed_.notify_all();
    }
    /// `condition` is asked under the mutex, now and then too.
    template <class Condition>
    bool wait(Condition condition) {
        std::unique_lock lock{mutex_};
        auto const deadline = std::chrono::steady_clock::now() + kHang;
        while (!condition()) {
            if (std::chrono::steady_clock::now() > deadline) {
                return false;
            }
            changed_.wait_for(lock, std::chrono::milliseconds{5});
        }
        return true;
    }
    [[nodiscard]] std::mutex& mutex() { return mutex_; }

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
};

[[nodiscard]] inline bus::EndpointQos qos(bool reliable, bool kept = false) {
    bus::EndpointQos out;
    out.reliable = reliable;
    out.durability = kept ? bus::Durability::transient_local : bus::Durability::volatile_;
    return out;
}

/// A program of a domain that writes and reads octets.
class Program {
  public:
    Program(std::string const& name, int domain);

    struct Heard {
        std::vector<std::byte> cdr;
        std::int64_t source_ns;
        std::string from; ///< process
    };
    /// All topics carry one type, `type`.
    bus::RawWriter& writes(std::string const& topic, bus::EndpointQos const& like = qos(true),
                           std::string_view type = "Octets", bool keyed = false);
    void reads(std::string const& topic, bus::EndpointQos const& like = qos(true), std::string_view type = "Octets",
               bool keyed = false);
    [[nodiscard]] std::size_t heard(std::string const& topic);
    [[nodiscard]] std::vector<Heard> all(std::string const& topic);
    bool wait_heard(std::string const& topic, std::size_t count);
    /// Writers of a topic that the reader is matched with.
    [[nodiscard]] std::size_t sources(std::string const& topic);
    bool wait_sources(std::string const& topic, std::size_t count);

  private:
    Signal signal_;
    std::map<std::string, std::vector<Heard>> heard_;
    std::unique_ptr<bus::Participant> participant_;
    std::map<std::string, std::unique_ptr<bus::RawWriter>> writers_;
    std::map<std::string, std::unique_ptr<bus::RawReader>> readers_;
};

/// Four octets of CDR header and a number.
[[nodiscard]] std::vector<std::byte> sample(std::uint32_t number);
[[nodiscard]] std::uint32_t number_of(std::vector<std::byte> const& cdr);
inline constexpr std::int64_t kStart = 1'575'190'800'000'000'000;

/// A router in this process, with a thread that does what its main function does; keeps what it reports.
class RunningRouter final : public Reporter {
  public:
    explicit RunningRouter(std::string const& yaml);
    ~RunningRouter() override;
    void stop();
    void note_silent_links() { router_->note_silent_links(); }

    struct Seen {
        std::vector<std::string> events;             ///< "connected wan b", "carries x a", "note …"
        std::map<std::string, std::uint64_t> totals; ///< samples by "topic from to"
    };
    [[nodiscard]] Seen seen();
    bool wait_for(std::string const& event, std::size_t times = 1);
    [[nodiscard]] std::size_t count(std::string const& event);

    void site(std::string const& end, std::string const& name, bool here, bool clean) override;
    void carries(Route const& route, RouterConfig const& config, bool now) override;
    void note(std::string const& text) override;
    void total(std::string const& topic, std::string const& from, std::string const& to, std::uint64_t samples,
               std::uint64_t octets, std::uint64_t refused, std::uint64_t dropped) override;

  private:
    void say(std::string event);

    RouterConfig config_;
    Signal signal_;
    Seen seen_;
    bool changed_{true}, stopping_{false};
    std::unique_ptr<Router> router_;
    std::thread thread_;
};

} // namespace gridspace::router
