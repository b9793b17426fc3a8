// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/participant.hpp"

#include <algorithm>
#include <atomic>
#include <fastdds/rtps/common/Guid.h>
#include <functional>
#include <map>
#include <mutex>
#include <set>

namespace gridspace::bus {

namespace rtps = eprosima::fastrtps::rtps;

/// The process of a GUID prefix; informs the owner about changes. Shared by the listeners of a participant.
class Directory {
  public:
    std::uint32_t index_of(rtps::GuidPrefix_t const& prefix) {
        std::lock_guard const lock{mutex_};
        return locked_index(prefix);
    }
    /// Nobody's when it has not been heard of.
    Peer peer_of(rtps::GuidPrefix_t const& prefix) const {
        std::lock_guard const lock{mutex_};
        auto const it = index_.find(prefix);
        return it == index_.end() ? Peer{} : peers_[it->second];
    }
    Peer peer(std::uint32_t index) const {
        std::lock_guard const lock{mutex_};
        return index < peers_.size() ? peers_[index] : Peer{};
    }
    void announce(rtps::GuidPrefix_t const& prefix, Peer peer) {
        {
            std::lock_guard const lock{mutex_};
            std::uint32_t const index = locked_index(prefix);
            peers_[index] = std::move(peer);
            here_.insert(index);
        }
        changed();
    }
    bool hears(Peer const& peer) const {
        std::lock_guard const lock{mutex_};
        return std::any_of(here_.begin(), here_.end(), [&](std::uint32_t index) {
            return peers_[index].process == peer.process && peers_[index].incarnation == peer.incarnation;
        });
    }
    std::vector<std::uint32_t> here() const {
        std::lock_guard const lock{mutex_};
        return {here_.begin(), here_.end()};
    }
    bool is_here(std::uint32_t index) const {
        std::lock_guard const lock{mutex_};
        return here_.contains(index);
    }
    void depart(rtps::GuidPrefix_t const& prefix, bool clean) {
        std::uint32_t index = 0;
        {
            std::lock_guard const lock{mutex_};
            index = locked_index(prefix);
            here_.erase(index);
        }
        {
            std::lock_guard const lock{callbacks_mutex_};
            if (on_departure_) {
                on_departure_(index, clean);
            }
        }
        changed();
    }
    void changed() {
        std::lock_guard const lock{callbacks_mutex_};
        if (on_change_) {
            on_change_();
        }
    }
    /// Waits for a call under way: afterwards the old callback is not called any more.
    void on_change(std::function<void()> callback) {
        std::lock_guard const lock{callbacks_mutex_};
        on_change_ = std::move(callback);
    }
    void on_departure(std::function<void(std::uint32_t, bool)> callback) {
        std::lock_guard const lock{callbacks_mutex_};
        on_departure_ = std::move(callback);
    }
    /// Writers do not wait for acknowledgements: nobody needs any, or a reader acknowledges nothing, which delays the
    /// leaving of this participant once, not once for each writer.
    std::atomic<bool> leaves_at_once{false};

  private:
    std::uint32_t locked_index(rtps::GuidPrefix_t const& prefix) {
        auto const [it, added] = index_.try_emplace(prefix, static_cast<std::uint32_t>(peers_.size()));
        if (added) {
            peers_.emplace_back();
        }
        return it->second;
    }

    mutable std::mutex mutex_;
    std::map<rtps::GuidPrefix_t, std::uint32_t> index_;
    std::vector<Peer> peers_;
    std::set<std::uint32_t> here_; ///< those that have not departed
    std::mutex callbacks_mutex_;   // guards the next two, also while they are called
    std::function<void()> on_change_;
    std::function<void(std::uint32_t, bool)> on_departure_;
};

/// The endpoints that discovery has told of. As many as the participant's limits let be (bound_the_others).
class KnownEndpoints {
  public:
    void found(rtps::GUID_t const& guid, std::string topic, bool writer) {
        std::lock_guard const lock{mutex_};
        all_[guid] = {std::move(topic), writer};
    }
    void gone(rtps::GUID_t const& guid) {
        std::lock_guard const lock{mutex_};
        all_.erase(guid);
    }
    /// The participants that have one on a topic.
    [[nodiscard]] std::vector<rtps::GuidPrefix_t> on(std::string const& topic, bool writers) const {
        std::vector<rtps::GuidPrefix_t> out;
        std::lock_guard const lock{mutex_};
        for (auto const& [guid, known] : all_) {
            if (known.writer == writers && known.topic == topic) {
                out.push_back(guid.guidPrefix);
            }
        }
        return out;
    }

  private:
    struct Known {
        std::string topic;
        bool writer{false};
    };
    mutable std::mutex mutex_;
    std::map<rtps::GUID_t, Known> all_;
};

/// The endpoints that one endpoint is matched with.
class Matches {
  public:
    void update(rtps::GUID_t const& guid, int change) {
        std::lock_guard const lock{mutex_};
        if (change > 0) {
            guids_.insert(guid);
        } else {
            guids_.erase(guid);
        }
    }
    std::vector<Peer> peers(Directory& directory) const {
        std::vector<Peer> out;
        std::lock_guard const lock{mutex_};
        for (rtps::GUID_t const& guid : guids_) {
            out.push_back(directory.peer(directory.index_of(guid.guidPrefix)));
        }
        return out;
    }

  private:
    mutable std::mutex mutex_;
    std::set<rtps::GUID_t> guids_;
};

} // namespace gridspace::bus
