// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/directory_impl.hpp"
#include "bus/unauthenticated.hpp"
#include "common/text.hpp"

#include <fmt/format.h>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace gridspace::bus {

/// On a secured bus: who has announced himself, and who has shown who he is. Only who has done both is here for the
/// rest of a process. The library reports the two in any order, from several threads.
class Authentication {
  public:
    struct Waiting {
        Peer peer;
        std::vector<std::string> addresses;
    };
    static constexpr std::size_t kMostTold = 64; ///< somebody may invent participants without end

    /// He announces himself: true when he is to be known now.
    bool announced(rtps::GuidPrefix_t const& prefix, Peer const& peer, std::vector<std::string> addresses) {
        std::lock_guard const lock{mutex_};
        if (genuine_.contains(prefix)) {
            return true;
        }
        if (waiting_.size() < kMostWaiting) {
            waiting_[prefix] = {peer, std::move(addresses)};
        }
        return false;
    }
    /// He has shown who he is: as whom he is to be known now, when he has announced himself.
    std::optional<Waiting> authorized(rtps::GuidPrefix_t const& prefix) {
        std::lock_guard const lock{mutex_};
        genuine_.insert(prefix);
        auto const found = waiting_.extract(prefix);
        return found.empty() ? std::nullopt : std::optional{found.mapped()};
    }
    /// It could not: what to report about it, once.
    std::optional<std::string> refused(rtps::GuidPrefix_t const& prefix) {
        std::lock_guard const lock{mutex_};
        if (told_.size() >= kMostTold || !told_.insert(prefix).second) {
            return std::nullopt;
        }
        auto const found = waiting_.find(prefix);
        bool const known = found != waiting_.end();
        return fmt::format("a participant that calls itself '{}'{} could not show who it is: it hears and says nothing",
                           known ? found->second.peer.process : "",
                           known && !found->second.addresses.empty() ? " at " + join(found->second.addresses, ", ")
                                                                     : "");
    }
    /// He is gone: true when he was known.
    bool gone(rtps::GuidPrefix_t const& prefix) {
        std::lock_guard const lock{mutex_};
        waiting_.erase(prefix);
        return genuine_.erase(prefix) > 0;
    }

  private:
    static constexpr std::size_t kMostWaiting = 4096;
    std::mutex mutex_;
    std::map<rtps::GuidPrefix_t, Waiting> waiting_;
    std::set<rtps::GuidPrefix_t> genuine_, told_;
};

} // namespace gridspace::bus
