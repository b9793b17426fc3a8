// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

namespace gridspace::sim::emt {

/// What was at nearly uniform instants: a ring of entries, each with its time `t`.
template <class Entry>
class Past {
  public:
    Past() = default;
    Past(std::size_t size, double step_s) : ring_(size), step_s_{step_s} {}

    [[nodiscard]] std::size_t size() const { return ring_.size(); }
    void clear() { written_ = 0; }
    /// The place of the next entry, which becomes the newest.
    [[nodiscard]] Entry& next() { return ring_[written_++ % ring_.size()]; }
    [[nodiscard]] Entry& newest() { return ring_[(written_ - 1) % ring_.size()]; }

    /// The entries around an instant, and its share of the time between them.
    struct Around {
        Entry const &older, &newer;
        double share{1};
    };
    [[nodiscard]] Around around(double t) const {
        std::size_t const size = ring_.size();
        std::size_t newer = written_ - 1;
        std::size_t const oldest = written_ > size ? written_ - size : 0;
        // Times are nearly uniform: jump near, then look.
        double const behind = (ring_[newer % size].t - t) / step_s_;
        if (behind > 2) {
            newer -= std::min(newer - oldest, static_cast<std::size_t>(behind) - 1);
        }
        while (newer + 1 < written_ && ring_[newer % size].t < t) {
            ++newer;
        }
        while (newer > oldest + 1 && ring_[(newer - 1) % size].t > t) {
            --newer;
        }
        Entry const& b = ring_[newer % size];
        Entry const& a = ring_[(newer > oldest ? newer - 1 : newer) % size];
        return {a, b, b.t > a.t ? std::clamp((t - a.t) / (b.t - a.t), 0.0, 1.0) : 1};
    }

    /// For going back to an earlier instant.
    [[nodiscard]] std::size_t mark() const { return written_; }
    void back_to(std::size_t mark) { written_ = mark; }

  private:
    std::vector<Entry> ring_;
    double step_s_{0};
    std::size_t written_{0};
};

} // namespace gridspace::sim::emt
