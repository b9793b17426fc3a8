// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gridspace::stream {

/// What a plot of `pixels` columns shows of a signal: at most two points per column, the lowest and the highest, each
/// at its time. Of rows that are left only as lowest and highest of many, that is where these rows begin (and end, for
/// the second of two from the same rows). Times do not decrease.
struct Plot {
    std::vector<double> times_s;
    std::vector<double> values;
};

/// Whether a plot has one point beyond each of its ends where there is one, or none.
enum class Ends { reach_out, inside };

/// The past of a group of signals that share their times, in bounded memory: the newest rows as they came, older ones
/// as the lowest and highest of 16, 256, … rows. Times increase. Pure: no clock, no lock.
class SignalWindow {
  public:
    struct Column {
        std::string name, unit;
        bool steps{false}; ///< rows come when something changes: a value holds until the next
    };
    /// `rows`: how many entries each of the levels keeps. `values_left`: what several windows may still take together;
    /// when nothing is left, each keeps what it has, a few rows at least.
    explicit SignalWindow(std::vector<Column> columns, std::size_t rows = 32768,
                          std::shared_ptr<std::size_t> values_left = nullptr);

    [[nodiscard]] std::vector<Column> const& columns() const { return columns_; }
    [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;

    /// One row: a value per column. A row that is not later than the newest is left out (it came twice).
    void append(std::int64_t time_ns, std::span<double const> values);

    [[nodiscard]] bool empty() const { return newest_.empty(); }
    [[nodiscard]] std::int64_t newest_ns() const { return newest_ns_; }
    [[nodiscard]] std::int64_t oldest_ns() const; ///< as far back as the coarsest level goes
    [[nodiscard]] double newest(std::size_t column) const { return newest_[column]; }
    /// The value that held at an instant (the lowest of a bucket where only buckets are left); NaN before the first.
    [[nodiscard]] double value_at(std::size_t column, std::int64_t time_ns) const;
    [[nodiscard]] std::uint64_t rows() const { return count_; }
    /// Of `values_left`: what comes back when it is given up.
    [[nodiscard]] std::size_t taken() const { return taken_; }

    /// The signal between two instants, with the last point before and the first after them, so that lines reach the
    /// edges.
    [[nodiscard]] Plot plot(std::size_t column, std::int64_t from_ns, std::int64_t to_ns, std::size_t pixels,
                            Ends ends = Ends::reach_out) const;

  private:
    struct Bucket {
        std::int64_t first_ns{0}, last_ns{0};
    };
    /// Lowest and highest of `span` consecutive rows, per column; a ring.
    struct Level {
        std::uint64_t span{1};
        std::size_t capacity{0};
        std::vector<Bucket> buckets;
        std::vector<float> low, high; ///< bucket after bucket, column after column
        std::uint64_t begun{0};       ///< buckets ever begun
        std::uint64_t filled{0};      ///< rows in the newest one
    };
    [[nodiscard]] std::size_t values_of(Level const& level) const { ///< in each entry
        return columns_.size() * (level.span > 1 ? 2 : 1);
    }
    [[nodiscard]] bool take_entry(Level const& level);
    void add(Level& level, std::int64_t time_ns, std::span<double const> values);
    [[nodiscard]] std::size_t kept(Level const& level) const;
    [[nodiscard]] Bucket const& bucket(Level const& level, std::size_t i) const;
    /// The finest that reaches back far enough; with as many entries that a column has at least one, coarser ones are
    /// quicker.
    [[nodiscard]] Level const& level_from(std::int64_t from_ns) const;
    /// The first one, and one past the last.
    [[nodiscard]] std::pair<std::size_t, std::size_t> buckets_between(Level const& level, std::int64_t from_ns,
                                                                      std::int64_t to_ns, Ends ends) const;

    std::vector<Column> columns_;
    std::shared_ptr<std::size_t> values_left_; ///< none: no limit but the rows
    std::size_t taken_{0};
    std::vector<Level> levels_;
    std::vector<double> newest_;
    std::int64_t newest_ns_{INT64_MIN};
    std::uint64_t count_{0};
};

} // namespace gridspace::stream
