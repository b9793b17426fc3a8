// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/mcca/mcca_logic.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::agents {

std::optional<std::string> fault_of(MccaRequest const& request) {
    auto const is = [](char const* field, double value) {
        return fmt::format("{} is {}", field, std::isnan(value) ? "nan" : shortest(value));
    };
    if (!std::isfinite(request.current_a)) {
        return is("current_a", request.current_a);
    }
    if (std::isinf(request.v_pu)) {
        return is("v_pu", request.v_pu);
    }
    if (!std::isfinite(request.period_s) || request.period_s < 0) {
        return is("period_s", request.period_s);
    }
    return std::nullopt;
}

Mcca::Mcca(Params params) : params_{std::move(params)}, asked_(params_.evs.size()) {}

std::optional<Mcca::Outcome> Mcca::request(SimTime time, MccaRequest const& request) {
    auto const ev = std::find(params_.evs.begin(), params_.evs.end(), request.ev);
    if (ev == params_.evs.end() || fault_of(request)) {
        return std::nullopt;
    }
    // A timeout that lies before this request decides first.
    std::optional<Outcome> late = elapse(time - SimSpan{1});
    asked_[static_cast<std::size_t>(ev - params_.evs.begin())] = request;
    if (!first_) {
        first_ = time;
    }
    if (late) {
        return late;
    }
    bool const all = std::all_of(asked_.begin(), asked_.end(), [](auto const& r) { return r.has_value(); });
    return all ? std::optional{decide(time, true)} : std::nullopt;
}

bool Mcca::serves(std::string_view ev) const {
    return std::find(params_.evs.begin(), params_.evs.end(), ev) != params_.evs.end();
}

std::optional<Mcca::Outcome> Mcca::elapse(SimTime now) {
    if (!first_ || now < *first_ + params_.request_timeout) {
        return std::nullopt;
    }
    return decide(*first_ + params_.request_timeout, false);
}

std::optional<SimTime> Mcca::deadline() const {
    return first_ ? std::optional{*first_ + params_.request_timeout} : std::nullopt;
}

Mcca::Outcome Mcca::decide(SimTime time, bool complete) {
    MccaRules const& rules = params_.rules;
    using Overlap = MccaRules::Overlap;
    double full_above = rules.full_above_pu;
    if (rules.overlap == Overlap::safe || (rules.overlap == Overlap::hysteresis && curtailed_)) {
        full_above = rules.full_again_above_pu;
    }
    bool all_full = true, undervoltage = false;
    for (auto const& asked : asked_) {
        if (asked) {
            all_full = all_full && asked->v_pu > full_above;
            undervoltage = undervoltage || !(asked->v_pu > rules.stop_at_pu);
        }
    }
    Outcome out;
    out.time = time;
    out.complete = complete;
    out.undervoltage = undervoltage;
    out.curtailed = undervoltage || !all_full;
    curtailed_ = out.curtailed;
    for (std::size_t i = 0; i < asked_.size(); ++i) {
        if (!asked_[i]) {
            continue;
        }
        double factor = 1;
        if (undervoltage) {
            factor = asked_[i]->v_pu > rules.stop_at_pu ? rules.undervoltage_factor : 0;
        } else if (!all_full) {
            factor = rules.curtail_factor;
        }
        out.decisions.push_back({asked_[i]->ev, asked_[i]->current_a * factor, factor});
        out.period_s = std::max(out.period_s, asked_[i]->period_s);
        asked_[i].reset();
    }
    first_.reset();
    return out;
}

} // namespace gridspace::agents
