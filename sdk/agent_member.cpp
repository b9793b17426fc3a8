// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sdk/agent_member.hpp"

#include "common/text.hpp"
#include "sdk/described_settings.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace gridspace::sdk {
namespace {

gridspace_agent* handle(AgentMember* member) {
    return static_cast<gridspace_agent*>(member);
}

/// From input to output, as the setting that the description names says.
SimSpan latency_of(program::Declaration const& declaration, config::Node const& settings, TimeBase const& base) {
    auto const text = declaration.latency.empty() ? std::nullopt : setting_at(settings, declaration.latency);
    auto const us = text ? Rational::parse(*text) : std::nullopt;
    return base.ceil(us.value_or(Rational{0}) / Rational{1'000'000});
}

template <class Ends>
std::optional<int> number_of(Ends const& ends, std::string_view topic) {
    auto found = std::find_if(ends.begin(), ends.end(), [&](auto const& end) { return end.topic == topic; });
    if (found == ends.end()) {
        found = std::find_if(ends.begin(), ends.end(), [&](auto const& end) { return end.declared == topic; });
    }
    return found == ends.end() ? std::nullopt : std::optional{static_cast<int>(found - ends.begin())};
}

} // namespace

AgentMember::AgentMember(DescribedProgram const& program, config::Node settings, gateways::WireConfig const& wire,
                         bus::Node& node)
    : program_{program}, wire_{wire}, settings_{with_defaults(settings, program.declaration.settings)},
      settings_json_{to_json(settings_, program.declaration.settings)}, node_{node},
      latency_{latency_of(program.declaration, settings_, node.time_base())}, grid_{node.config().clock} {}

AgentMember::~AgentMember() = default;

void AgentMember::begin(bus::Tick const& tick) {
    if (signals_ != nullptr) {
        signals_->announce(tick.time);
    }
    now_ = tick.time;
    if (streams_ != nullptr) {
        streams_->begin(tick);
    }
    begins_ = true;
    if (program_.callbacks.begin != nullptr) {
        begun_ = returned(program_.callbacks.begin(handle(this), program_.callbacks.user), "begin");
    }
    begins_ = false;
}

Result<void> AgentMember::work(bus::Tick const& tick) {
    if (!begun_) {
        return begun_;
    }
    // Who was paused goes on with what is due now: what it would have done meanwhile is of no use any more.
    timers_.skip([&](SimTime due, SimSpan period) {
        return node_.lockstep() ? node_.is_over(due, tick) : due + period <= tick.time;
    });
    for (std::size_t i = 0; i < readers_.size(); ++i) {
        if (readers_[i].inbox != nullptr) {
            readers_[i].inbox->take(static_cast<int>(i), arrivals_);
        }
    }
    if (streams_ != nullptr) {
        streams_->take(tick, arrivals_);
    }
    std::sort(arrivals_.begin(), arrivals_.end(),
              [](auto const& a, auto const& b) { return std::tie(a.origin, a.reader) < std::tie(b.origin, b.reader); });
    auto ok = hand_over(tick);
    arrivals_.clear();
    if (streams_ != nullptr) {
        streams_->finish(tick);
    }
    if (ok && tick.final && signals_ != nullptr) {
        signals_->flush();
    }
    return ok;
}

Result<void> AgentMember::hand_over(bus::Tick const& tick) {
    gridspace_program const& callbacks = program_.callbacks;
    auto arrival = arrivals_.begin();
    while (true) {
        auto timer = timers_.next();
        if (timer && timer->time > tick.time) {
            timer.reset();
        }
        Result<void> ok;
        if (arrival != arrivals_.end() && (!timer || arrival->origin.time <= timer->time)) {
            goes_on_to(arrival->origin.time);
            if (callbacks.sample != nullptr) {
                std::size_t const size = readers_[static_cast<std::size_t>(arrival->reader)].type->layout().size();
                ok = returned(
                    callbacks.sample(handle(this), arrival->reader, arrival->sample.get(), size, callbacks.user),
                    "sample");
            }
            ++arrival;
        } else if (timer) {
            goes_on_to(timer->time);
            timers_.passed(timer->timer); // before the call, which may cancel it
            if (callbacks.due != nullptr) {
                ok = returned(callbacks.due(handle(this), timer->timer, callbacks.user), "due");
            }
        } else {
            return {};
        }
        if (!ok) {
            return ok;
        }
    }
}

void AgentMember::goes_on_to(SimTime now) {
    now_ = now;
    if (streams_ != nullptr) {
        streams_->send_before(now);
    }
}

std::uint64_t AgentMember::next_tick(bus::Tick const& tick) const {
    if (works_in_every_tick_) {
        return tick.number + 1;
    }
    auto const timer = timers_.next();
    auto const frame = streams_ != nullptr ? streams_->next() : std::nullopt;
    return std::min(timer ? grid_.tick_of(timer->time) : bus::TickGrid::kNever,
                    frame ? grid_.tick_of(*frame) : bus::TickGrid::kNever);
}

std::optional<std::chrono::steady_clock::time_point> AgentMember::deadline() const {
    return streams_ != nullptr ? std::optional{streams_->deadline()} : std::nullopt;
}

void AgentMember::end(bus::Tick const&) {
    if (streams_ != nullptr) {
        streams_->end();
    }
    if (program_.callbacks.end != nullptr) {
        program_.callbacks.end(handle(this), program_.callbacks.user);
    }
}

Result<void> AgentMember::returned(int code, std::string_view callback) {
    if (failure_) {
        return std::unexpected{*failure_};
    }
    if (code != 0) {
        return fail(ExitCode::child_died,
                    refused_.empty() ? fmt::format("its callback '{}' returned {}", callback, code) : refused_,
                    "gridspace_fail says why in the program's own words");
    }
    refused_.clear();
    if (std::exchange(row_is_new_, false)) {
        signals_->row(effect_time(), row_);
    }
    return {};
}

std::string const* AgentMember::setting(std::string_view path) const {
    if (auto const known = asked_.find(path); known != asked_.end()) {
        return &known->second;
    }
    auto text = setting_at(settings_, path);
    return text ? &asked_.emplace(path, std::move(*text)).first->second : nullptr;
}

Result<int> AgentMember::every(std::string_view period_s) {
    auto const seconds = Rational::parse(period_s);
    SimSpan const period = seconds ? node_.time_base().nearest(*seconds) : SimSpan{};
    if (period.quanta <= 0) {
        return fail(ExitCode::usage,
                    fmt::format("a timer every '{}' s: expected a number of seconds, at least the {} s that time is "
                                "counted in",
                                period_s, node_.time_base().quantum_s().to_string()),
                    "\"60\", \"0.25\" or \"1/4800\"");
    }
    // Who begins late, begins with the period that it is in.
    return timers_.every(period, begins_ ? now_ : now_ + SimSpan{period.quanta - 1});
}

Result<int> AgentMember::at(std::int64_t time_ns) {
    SimTime const time = node_.time_base().from_nanoseconds(time_ns);
    if (time < now_) {
        return fail(ExitCode::usage,
                    fmt::format("a timer at {} s, and it is {} s already", shortest(node_.time_base().seconds(time)),
                                shortest(node_.time_base().seconds(now_))));
    }
    return timers_.at(time);
}

Result<void> AgentMember::cancel(int timer) {
    return timers_.cancel(timer) ? Result<void>{} : fail(ExitCode::usage, fmt::format("there is no timer {}", timer));
}

std::optional<int> AgentMember::reader(std::string_view topic) const {
    return number_of(readers_, topic);
}

std::optional<int> AgentMember::writer(std::string_view topic) const {
    return number_of(writers_, topic);
}

std::optional<int> AgentMember::signal_number(std::string_view name) const {
    auto const found =
        std::find_if(columns_.begin(), columns_.end(), [&](bus::SignalColumn const& c) { return c.name == name; });
    return found == columns_.end() ? std::nullopt : std::optional{static_cast<int>(found - columns_.begin())};
}

Result<int> AgentMember::declared_signal(std::string_view declared, std::optional<std::string_view> value) const {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < origins_.size(); ++i) {
        if (origins_[i].declared != declared || (value && origins_[i].value != *value)) {
            continue;
        }
        if (found) {
            return fail(ExitCode::usage,
                        fmt::format("'{}' is several signals, '{}' and '{}' among them", declared,
                                    columns_[*found].name, columns_[i].name),
                        fmt::format("say which: of '{}', or of '{}'", origins_[*found].value, origins_[i].value));
        }
        found = i;
    }
    return found ? Result<int>{static_cast<int>(*found)}
                 : fail(ExitCode::usage,
                        value ? fmt::format("'{}' is no signal for '{}'", declared, *value)
                              : fmt::format("'{}' is no signal here: what it is named after is not given", declared));
}

Result<void> AgentMember::write(int number, void const* sample, std::size_t size) {
    if (number < 0 || static_cast<std::size_t>(number) >= writers_.size()) {
        return fail(ExitCode::usage,
                    fmt::format("there is no writer {}: the description names {} topics that it writes", number,
                                writers_.size()));
    }
    Writer& writer = writers_[static_cast<std::size_t>(number)];
    TopicType const& type = *writer.type;
    if (size != type.layout().size()) {
        return fail(ExitCode::usage,
                    fmt::format("a sample of {} octets for '{}', whose type {} has {}", size, writer.topic, type.name(),
                                type.layout().size()),
                    "its struct is of another IDL: make it again with `gridspace types`");
    }
    SimTime const effect = effect_time();
    if (auto const offset = type.time_offset()) {
        auto const* const octets = static_cast<std::byte const*>(sample);
        sample_.assign(octets, octets + size);
        std::int64_t const time_ns = node_.time_base().nanoseconds(effect);
        std::memcpy(sample_.data() + *offset, &time_ns, sizeof time_ns);
        sample = sample_.data();
    }
    if (auto ok = idl::encode(type.layout(), sample, cdr_); !ok) {
        return ok;
    }
    if (writer.cdr == nullptr) {
        streams_->write(writer.stream, cdr_, now_);
        return {};
    }
    auto const key = type.key_hash(cdr_);
    writer.cdr->write(cdr_, effect, key ? &*key : nullptr);
    return {};
}

Result<void> AgentMember::signal(int number, double value) {
    if (number < 0 || static_cast<std::size_t>(number) >= row_.size()) {
        return fail(ExitCode::usage, fmt::format("there is no signal {}: the description has {}", number, row_.size()));
    }
    if (!std::isfinite(value)) {
        return fail(ExitCode::usage, fmt::format("the signal '{}' is {}, which is not finite",
                                                 columns_[static_cast<std::size_t>(number)].name, value));
    }
    row_[static_cast<std::size_t>(number)] = value;
    row_is_new_ = true;
    return {};
}

void AgentMember::fail_with(Error error) {
    if (!failure_) {
        failure_ = std::move(error);
    }
}

} // namespace gridspace::sdk
