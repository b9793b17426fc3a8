// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/door/door.hpp"

#include "bus/raw_access.hpp"
#include "common/exit_code.hpp"
#include "common/log.hpp"
#include "common/unique_fd.hpp"
#include "timebox/door/door_message.hpp"
#include "timebox/door_channel.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <deque>
#include <fmt/format.h>
#include <mutex>
#include <poll.h>
#include <string_view>
#include <sys/eventfd.h>
#include <sys/socket.h>

namespace gridspace::timebox {
namespace {

constexpr std::string_view kWord = "door";
constexpr std::size_t kWords = 4; ///< of a topic, on the command line

/// A topic on its way, and what it has been opened with: the QoS of the program's own endpoints.
struct Lane {
    DoorTopic topic;
    bus::Codec codec;
    std::uint32_t number{0}; ///< among those of its direction
    std::vector<bus::EndpointQos> opened;
    std::vector<std::unique_ptr<bus::RawReader>> readers;
    std::vector<std::unique_ptr<bus::RawWriter>> writers;
};

class Door final : bus::DiscoveryObserver {
  public:
    Door(std::filesystem::path qos, int domain, std::vector<DoorTopic> const& topics) : qos_{std::move(qos)} {
        options_.domain = domain;
        std::array<std::uint32_t, 2> counted{};
        for (DoorTopic const& topic : topics) {
            Lane& lane = lanes_.emplace_back();
            lane.topic = topic;
            lane.codec.type_name = lane.topic.type;
            lane.codec.keyed = topic.keyed;
            lane.number = counted[topic.to_program ? 1 : 0]++;
        }
    }

    Result<void> run() {
        options_.process = options_.program = "gridspace-door";
        options_.qos_file = qos_;
        options_.addresses = {"127.0.0.1"};
        auto participant = bus::Participant::create(options_, this);
        if (!participant) {
            return std::unexpected{participant.error()};
        }
        participant_ = std::move(*participant);
        while (true) {
            std::array<pollfd, 2> list{pollfd{kDoorFd, POLLIN, 0}, pollfd{bell_.get(), POLLIN, 0}};
            if (::poll(list.data(), list.size(), -1) < 0 && errno != EINTR) {
                return fail(ExitCode::environment, "the door cannot wait");
            }
            if ((list[1].revents & POLLIN) != 0) {
                if (auto ok = open_found(); !ok) {
                    return ok;
                }
            }
            if ((list[0].revents & (POLLIN | POLLHUP)) != 0 && !take_message()) {
                return {}; // the box is at its end
            }
        }
    }

  private:
    // On threads of DDS:
    void participant_found(bus::DiscoveredParticipant const&) override {}
    void participant_gone(std::string const&, bool) override {}
    void endpoint_gone(std::string const&) override {}
    void endpoint_found(bus::DiscoveredEndpoint const& endpoint) override {
        {
            std::lock_guard const lock{mutex_};
            found_.push_back(endpoint);
        }
        std::uint64_t const one = 1;
        (void)!::write(bell_.get(), &one, sizeof one);
    }

    /// An endpoint of ours for each of the program's, so that whatever QoS it asks for is what it gets.
    Result<void> open_found() {
        std::uint64_t rings = 0;
        (void)!::read(bell_.get(), &rings, sizeof rings);
        std::deque<bus::DiscoveredEndpoint> found;
        {
            std::lock_guard const lock{mutex_};
            found.swap(found_);
        }
        for (bus::DiscoveredEndpoint const& endpoint : found) {
            for (Lane& lane : lanes_) {
                if (lane.topic.topic != endpoint.topic || lane.topic.to_program == endpoint.writer) {
                    continue;
                }
                if (auto ok = open(lane, endpoint); !ok) {
                    return ok;
                }
            }
        }
        return {};
    }

    Result<void> open(Lane& lane, bus::DiscoveredEndpoint const& endpoint) {
        if (endpoint.type != lane.topic.type || endpoint.keyed != lane.topic.keyed) {
            log::warning("the program {} '{}' as {}{}, and the scenario says {}{}: nothing is exchanged",
                         endpoint.writer ? "writes" : "reads", lane.topic.topic, endpoint.type,
                         endpoint.keyed ? " with a key" : "", lane.topic.type, lane.topic.keyed ? " with a key" : "");
            return {};
        }
        if (std::ranges::find(lane.opened, endpoint.qos) != lane.opened.end()) {
            return {};
        }
        lane.opened.push_back(endpoint.qos);
        if (lane.topic.to_program) {
            auto writer = bus::create_writer_like(*participant_, lane.topic.topic, lane.codec, endpoint.qos);
            if (!writer) {
                return std::unexpected{writer.error()};
            }
            lane.writers.push_back(std::move(*writer));
            return {};
        }
        auto reader = bus::create_reader_like(
            *participant_, lane.topic.topic, lane.codec, endpoint.qos,
            [number = lane.number](std::span<std::byte const> cdr, bus::SampleHeader const&) {
                DoorMessage message;
                message.topic = number;
                auto const octets = to_octets(message, cdr);
                if (::send(kDoorFd, octets.data(), octets.size(), MSG_NOSIGNAL) < 0) {
                    log::warning("a sample of {} octets does not fit through the door: it is lost", cdr.size());
                }
            });
        if (!reader) {
            return std::unexpected{reader.error()};
        }
        lane.readers.push_back(std::move(*reader));
        return {};
    }

    bool take_message() {
        ssize_t const got = ::recv(kDoorFd, buffer_.data(), buffer_.size(), 0);
        if (got <= 0) {
            return got < 0 && errno == EINTR;
        }
        auto const octets = std::span{buffer_}.first(static_cast<std::size_t>(got));
        auto const message = door_message(octets);
        for (Lane& lane : lanes_) {
            if (!message || !lane.topic.to_program || lane.number != message->topic) {
                continue;
            }
            for (auto const& writer : lane.writers) {
                (void)writer->write_cdr(octets.subspan(sizeof *message), message->source_ns,
                                        message->keyed != 0 ? &message->key_hash : nullptr);
            }
        }
        return true;
    }

    bus::ParticipantOptions options_;
    std::filesystem::path qos_;
    UniqueFd bell_{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
    std::mutex mutex_; // guards found_
    std::deque<bus::DiscoveredEndpoint> found_;
    std::deque<Lane> lanes_;
    std::vector<std::byte> buffer_{std::size_t{1} << 20U};
    std::unique_ptr<bus::Participant> participant_; // its endpoints, in lanes_, go first: see run_door
};

} // namespace

std::vector<std::string> door_command(std::filesystem::path const& qos, std::int64_t domain,
                                      std::vector<DoorTopic> const& topics) {
    std::error_code ignored;
    std::vector<std::string> out{std::filesystem::read_symlink("/proc/self/exe", ignored).string(), std::string{kWord},
                                 qos.string(), std::to_string(domain)};
    for (DoorTopic const& topic : topics) {
        out.insert(out.end(), {topic.to_program ? "reads" : "writes", topic.topic, topic.type,
                               topic.keyed ? "keyed" : "without_key"});
    }
    return out;
}

bool is_door(int argc, char** argv) {
    return argc > 3 && argv[1] == kWord;
}

int run_door(int argc, char** argv) {
    std::vector<std::string> const words{argv + 2, argv + argc};
    std::vector<DoorTopic> topics;
    for (std::size_t at = 2; at + kWords <= words.size(); at += kWords) {
        topics.push_back({words[at] == "reads", words[at + 1], words[at + 2], words[at + 3] == "keyed"});
    }
    Door door{words[0], static_cast<int>(std::strtol(words[1].c_str(), nullptr, 10)), topics};
    if (auto const ok = door.run(); !ok) {
        log::error("the door of the box: {}", ok.error().message);
        std::_Exit(static_cast<int>(ok.error().code));
    }
    std::_Exit(0); // no participant receives a dispose
}

} // namespace gridspace::timebox
