// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::lockstep {

/// Which participants of a network belong to the processes of a run. Until READY anybody counts as what he calls
/// himself, and who calls himself like a process that is here ends that process's start. From then on a process is who
/// was there, and nobody else under its name is obeyed. This is identification: who can send under the address and the
/// GUID of another is not found out without DDS Security. Pure; participants are numbers.
class Roster {
  public:
    enum class Standing : std::uint8_t {
        member,
        former,  ///< of an incarnation before the newest: what it sent is on its way still
        impostor ///< somebody else under the name of a process
    };
    struct Claim {
        std::string process;
        std::uint32_t incarnation{0};
        std::uint32_t participant{0};
    };

    /// READY, or everybody is READY again after a restart: who is here now, in the order in which they were found.
    void settle(std::vector<Claim> const& here) {
        for (Claim const& claim : here) {
            auto const [it, added] = known_.try_emplace(claim.process, Known{claim.incarnation, {}, {}, true});
            Known& known = it->second;
            if (claim.incarnation > known.incarnation && (!settled_ || may_restart(claim))) {
                renew(known, claim, true);
            } else if (known.is_open && claim.incarnation == known.incarnation) {
                add(known, claim.participant);
            }
        }
        for (auto& [process, known] : known_) {
            known.is_open = false;
        }
        settled_ = true;
        restarts_ = false;
        restarted_.reset();
    }

    /// The simulator holds the clock for a restart: a higher incarnation takes the place of the one before, until
    /// settle().
    void expect_restarts() { restarts_ = settled_; }
    [[nodiscard]] bool expects_restarts() const { return restarts_; }
    /// The simulator itself knows of whom.
    void expect_restart(std::string process, std::uint32_t incarnation) {
        restarted_ = Claim{std::move(process), incarnation, 0};
    }

    /// Whether what comes from a participant is obeyed. The first that is heard under a name that nobody had is it.
    /// `has_left(participant)`: real time, where a board may be switched on again by hand: its place is free when it
    /// has left the bus.
    template <class HasLeft>
    [[nodiscard]] Standing standing(Claim const& claim, HasLeft&& has_left) {
        if (!settled_) {
            return Standing::member;
        }
        auto const [it, added] =
            known_.try_emplace(claim.process, Known{claim.incarnation, {claim.participant}, {}, false});
        Known& known = it->second;
        if (contains(known.participants, claim.participant)) {
            return Standing::member;
        }
        if (contains(known.former, claim.participant)) {
            return Standing::former;
        }
        if (known.is_open && claim.incarnation == known.incarnation) {
            add(known, claim.participant);
            return Standing::member;
        }
        bool const returns = claim.incarnation > known.incarnation && may_restart(claim);
        if (returns || std::all_of(known.participants.begin(), known.participants.end(), has_left)) {
            renew(known, claim, returns);
            return Standing::member;
        }
        return Standing::impostor;
    }

  private:
    struct Known {
        std::uint32_t incarnation{0};
        std::vector<std::uint32_t> participants, former;
        bool is_open{false}; ///< a process may have several participants: they come until settle()
    };
    static bool contains(std::vector<std::uint32_t> const& list, std::uint32_t participant) {
        return std::find(list.begin(), list.end(), participant) != list.end();
    }
    static void add(Known& known, std::uint32_t participant) {
        if (!contains(known.participants, participant)) {
            known.participants.push_back(participant);
        }
    }
    static void renew(Known& known, Claim const& claim, bool is_open) {
        known.former.insert(known.former.end(), known.participants.begin(), known.participants.end());
        known.incarnation = claim.incarnation;
        known.participants = {claim.participant};
        known.is_open = is_open;
    }
    [[nodiscard]] bool may_restart(Claim const& claim) const {
        return restarts_ ||
               (restarted_ && restarted_->process == claim.process && restarted_->incarnation == claim.incarnation);
    }

    std::map<std::string, Known> known_; ///< by process
    bool settled_{false}, restarts_{false};
    std::optional<Claim> restarted_;
};

} // namespace gridspace::lockstep
