// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/signal_publisher.hpp"

#include "bus/topics.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <signals.h>

namespace gridspace::bus {

static_assert(kMaxSignals == MAX_SIGNALS);

struct SignalPublisher::Writers {
    std::unique_ptr<Writer<SignalCatalog>> catalog;
    std::unique_ptr<Writer<SignalFrame>> frames;
};

namespace {

std::vector<SignalColumn> columns_in(std::vector<program::Signal> signals) {
    std::vector<SignalColumn> out;
    for (program::Signal& signal : signals) {
        out.push_back({std::move(signal.name), std::move(signal.unit)});
    }
    return out;
}

} // namespace

Result<std::unique_ptr<SignalPublisher>>
SignalPublisher::create(Node& node, std::string group, std::vector<program::Signal> const& declared,
                        std::map<std::string, std::vector<std::string>, std::less<>> const& values) {
    auto const value = [&](std::string_view key) -> std::vector<std::string> {
        if (key == "process") {
            return {node.config().process};
        }
        auto const found = values.find(key);
        return found == values.end() ? std::vector<std::string>{} : found->second;
    };
    double const rate_hz = declared.empty() ? 0 : declared.front().rate_hz;
    return create(node, std::move(group), rate_hz, columns_in(program::expand(declared, value)));
}

std::vector<SignalColumn> SignalPublisher::columns_of(Node const& node, std::vector<program::Signal> const& declared) {
    return columns_in(program::expand(declared, [&](std::string_view) { return std::vector{node.config().process}; }));
}

Result<std::unique_ptr<SignalPublisher>> SignalPublisher::create(Node& node, std::string group, double rate_hz,
                                                                 std::vector<SignalColumn> columns) {
    if (columns.size() > kMaxSignals) {
        return fail(ExitCode::usage,
                    fmt::format("{} signals in group '{}', and {} fit", columns.size(), group, kMaxSignals),
                    "choose some with record.signals");
    }
    auto out = std::unique_ptr<SignalPublisher>{new SignalPublisher};
    out->node_ = &node;
    out->writers_ = std::static_pointer_cast<Writers>(node.signal_writers().lock());
    if (out->writers_ == nullptr) {
        auto catalog = node.writer<SignalCatalog>("signal_catalog");
        if (!catalog) {
            return std::unexpected{catalog.error()};
        }
        auto frames = node.writer<SignalFrame>("signals");
        if (!frames) {
            return std::unexpected{frames.error()};
        }
        out->writers_ = std::make_shared<Writers>(std::move(*catalog), std::move(*frames));
        node.signal_writers() = out->writers_;
    }
    out->catalog_ = std::make_unique<SignalCatalog>();
    out->frame_ = std::make_unique<SignalFrame>();
    out->catalog_->source(node.config().process.c_str());
    out->catalog_->group(group.c_str());
    out->catalog_->rate_hz(rate_hz);
    for (SignalColumn const& column : columns) {
        SignalInfo info;
        info.name(column.name.c_str());
        info.unit(column.unit.c_str());
        out->catalog_->columns().push_back(info);
    }
    out->frame_->source(node.config().process.c_str());
    out->frame_->group(group.c_str());
    out->columns_ = columns.size();
    // About twenty frames a second of simulated time; what fits at high rates.
    std::size_t const fits =
        std::min<std::size_t>(MAX_FRAME_ROWS, MAX_FRAME_VALUES / std::max<std::size_t>(1, columns.size()));
    out->rows_per_frame_ =
        std::clamp<std::size_t>(static_cast<std::size_t>(rate_hz / 20), 1, std::max<std::size_t>(1, fits));
    out->frame_->times_ns().reserve(out->rows_per_frame_);
    out->frame_->values().reserve(out->rows_per_frame_ * columns.size());
    return out;
}

SignalPublisher::~SignalPublisher() = default;

void SignalPublisher::announce(SimTime now) {
    writers_->catalog->write(*catalog_, now);
}

void SignalPublisher::row(SimTime time, std::span<double const> values) {
    frame_->times_ns().push_back(node_->time_base().nanoseconds(time));
    frame_->values().insert(frame_->values().end(), values.begin(),
                            values.begin() + static_cast<std::ptrdiff_t>(columns_));
    last_ = time;
    if (frame_->times_ns().size() >= rows_per_frame_) {
        flush();
    }
}

void SignalPublisher::flush() {
    if (!frame_->times_ns().empty()) {
        writers_->frames->write(*frame_, last_);
        frame_->times_ns().clear();
        frame_->values().clear();
    }
}

} // namespace gridspace::bus
