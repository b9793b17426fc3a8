// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/raw_access.hpp"
#include "common/idl/key.hpp"
#include "router/router_config.hpp"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

namespace gridspace::router {

/// What has become of the samples of a topic that go from one end into another, however often its lane was opened.
struct Total {
    std::uint64_t samples{0}, octets{0}; ///< written; of the end's own thread
    std::uint64_t refused{0};            ///< by DDS, or not of their type
    std::atomic<std::uint64_t> dropped{0};
};

/// One topic on its way into an end.
struct Lane {
    std::string topic;
    std::unique_ptr<bus::RawWriter> writer;
    idl::Model model; ///< of a keyed type whose IDL is known
    std::optional<idl::KeyFinder> key;
    Total* total{nullptr}; ///< set before anything is carried; outlives the end
};

/// An end: its participant, and a thread that writes what is carried into it, so that nobody who receives ever waits.
class End {
  public:
    /// `qos_file`: profiles of the router's endpoints. `observer` must outlive the end. `freed`: called from a thread
    /// when a closed lane has been given up, so its topic may be opened with another type.
    [[nodiscard]] static Result<std::unique_ptr<End>> open(EndConfig const& config, std::string const& router,
                                                           std::filesystem::path const& qos_file,
                                                           bus::DiscoveryObserver* observer,
                                                           std::function<void()> freed);
    ~End();

    [[nodiscard]] Result<std::unique_ptr<bus::RawReader>> read(std::string const& topic, bus::Codec const& codec,
                                                               bus::EndpointQos const& qos, bus::SampleHandler handler);
    [[nodiscard]] Result<std::shared_ptr<Lane>> open_lane(std::string const& topic, bus::Codec const& codec,
                                                          bus::EndpointQos const& qos, std::int32_t depth,
                                                          std::string_view idl);
    /// Samples are written in the order in which they come; when too many wait, the oldest are dropped. Thread-safe.
    void carry(std::shared_ptr<Lane> const& lane, std::span<std::byte const> cdr, std::int64_t source_ns);
    /// The lane is given up when its last sample has been written and, for a moment, acknowledged.
    void close_lane(std::shared_ptr<Lane> lane);
    [[nodiscard]] bus::Peer peer(std::uint32_t index) const { return participant_->peer(index); }
    /// Writes the IDL of a type for those who want to decode it.
    void publish_type(std::string const& type, std::string const& idl);

  private:
    struct Item {
        std::shared_ptr<Lane> lane;
        std::vector<std::byte> cdr;
        std::int64_t source_ns{0};
        bool last{false};
    };
    explicit End(EndConfig const& config) : config_{config} {}
    [[nodiscard]] Result<void> inside(std::function<Result<void>()> const& body) const;
    void write_waiting(std::stop_token const& stop);
    void write(Item const& item);
    void give_up_closed(bool at_once);

    EndConfig const& config_;
    std::function<void()> freed_;
    std::unique_ptr<bus::Participant> participant_;
    std::unique_ptr<bus::RawWriter> types_;
    std::mutex mutex_; // guards the next two
    std::deque<Item> waiting_;
    std::size_t waiting_octets_{0};
    std::condition_variable_any arrived_;
    struct Closed {
        std::shared_ptr<Lane> lane;
        std::chrono::steady_clock::time_point until;
    };
    std::vector<Closed> closed_; ///< whose last samples may not be acknowledged yet; of the end's own thread
    std::jthread thread_;
};

} // namespace gridspace::router
