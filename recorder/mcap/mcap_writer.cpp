// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/mcap/mcap_writer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <utility>
#include <zlib.h>
#include <zstd.h>

namespace gridspace::mcap {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Of zstd. Chunks of 1 MiB at 2 cost what 256 KiB at 1 did; higher levels save 2 % and take twice the time.
constexpr int kLevel = 2;

/// Appends little-endian numbers and length-prefixed texts.
class Encoder {
  public:
    explicit Encoder(Bytes& out) : out_{out} {}
    template <class T>
    Encoder& number(T value) {
        auto const octets = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
        if constexpr (std::endian::native == std::endian::little) {
            out_.insert(out_.end(), octets.begin(), octets.end());
        } else {
            out_.insert(out_.end(), octets.rbegin(), octets.rend());
        }
        return *this;
    }
    Encoder& text(std::string const& text) {
        number(static_cast<std::uint32_t>(text.size()));
        out_.insert(out_.end(), text.begin(), text.end());
        return *this;
    }
    Encoder& texts(std::map<std::string, std::string> const& map) {
        Bytes body;
        Encoder inner{body};
        for (auto const& [key, value] : map) {
            inner.text(key).text(value);
        }
        number(static_cast<std::uint32_t>(body.size()));
        out_.insert(out_.end(), body.begin(), body.end());
        return *this;
    }
    template <class K, class V>
    Encoder& numbers(std::map<K, V> const& map) {
        number(static_cast<std::uint32_t>(map.size() * (sizeof(K) + sizeof(V))));
        for (auto const& [key, value] : map) {
            number(key).number(value);
        }
        return *this;
    }

  private:
    Bytes& out_;
};

void record(Bytes& out, Op op, Bytes const& body) {
    out.push_back(static_cast<std::uint8_t>(op));
    Encoder{out}.number(static_cast<std::uint64_t>(body.size()));
    out.insert(out.end(), body.begin(), body.end());
}

Bytes schema_body(Schema const& s) {
    Bytes body;
    Encoder{body}.number(s.id).text(s.name).text(s.encoding).text(s.data);
    return body;
}

Bytes channel_body(Channel const& c) {
    Bytes body;
    Encoder{body}.number(c.id).number(c.schema_id).text(c.topic).text(c.message_encoding).texts(c.metadata);
    return body;
}

std::uint32_t checksum(Bytes const& bytes) {
    return static_cast<std::uint32_t>(::crc32(0, bytes.data(), static_cast<uInt>(bytes.size())));
}

} // namespace

Result<Writer> Writer::create(std::filesystem::path const& file, Options options) {
    UniqueFd fd{::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)};
    if (!fd) {
        return fail(ExitCode::environment, fmt::format("cannot write '{}': {}", file.string(), std::strerror(errno)));
    }
    Writer writer{std::move(fd), file, options};
    Bytes head{kMagic.begin(), kMagic.end()};
    Bytes body;
    Encoder{body}.text("").text("gridspace");
    record(head, Op::header, body);
    if (auto ok = writer.put(head); !ok) {
        return std::unexpected{ok.error()};
    }
    return writer;
}

Writer::Writer(UniqueFd fd, std::filesystem::path file, Options options)
    : fd_{std::move(fd)}, file_{std::move(file)}, options_{options} {
    chunk_.reserve(options_.chunk_octets + 64 * 1024);
}

Result<void> Writer::put(std::vector<std::uint8_t> const& bytes) {
    std::size_t done = 0;
    while (done < bytes.size() && !failed_) {
        ssize_t const written = ::write(fd_.get(), bytes.data() + done, bytes.size() - done);
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written <= 0) {
            failed_ = true; // a half-written record would hide everything after it: no more is written
            return fail(ExitCode::environment,
                        fmt::format("cannot write '{}': {}", file_.string(), std::strerror(errno)),
                        errno == ENOSPC ? "the disk is full; what was recorded before is readable" : "");
        }
        done += static_cast<std::size_t>(written);
    }
    position_ += done;
    return failed_ ? fail(ExitCode::environment, fmt::format("'{}' could not be written before", file_.string()))
                   : Result<void>{};
}

std::uint16_t Writer::add_schema(std::string name, std::string encoding, std::string data) {
    auto const id = static_cast<std::uint16_t>(schemas_.size() + 1);
    schemas_.push_back({id, std::move(name), std::move(encoding), std::move(data)});
    record(chunk_, Op::schema, schema_body(schemas_.back()));
    return id;
}

std::uint16_t Writer::add_channel(std::uint16_t schema, std::string topic, std::string message_encoding,
                                  std::map<std::string, std::string> metadata) {
    auto const id = static_cast<std::uint16_t>(channels_.size());
    channels_.push_back({id, schema, std::move(topic), std::move(message_encoding), std::move(metadata)});
    record(chunk_, Op::channel, channel_body(channels_.back()));
    return id;
}

Result<void> Writer::write(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
                           std::span<std::byte const> data) {
    auto& index = chunk_messages_[channel];
    index.emplace_back(time_ns, chunk_.size());
    bool const first_of_chunk = std::exchange(chunk_has_messages_, true) == false;
    chunk_start_ = first_of_chunk ? time_ns : std::min(chunk_start_, time_ns);
    chunk_end_ = first_of_chunk ? time_ns : std::max(chunk_end_, time_ns);
    first_time_ = message_count_ == 0 ? time_ns : std::min(first_time_, time_ns);
    last_time_ = std::max(last_time_, time_ns);
    ++message_count_;
    ++channel_counts_[channel];

    chunk_.push_back(static_cast<std::uint8_t>(Op::message));
    Encoder encoder{chunk_};
    encoder.number(static_cast<std::uint64_t>(22 + data.size()));
    encoder.number(channel).number(sequence).number(time_ns).number(time_ns);
    auto const* octets = reinterpret_cast<std::uint8_t const*>(data.data());
    chunk_.insert(chunk_.end(), octets, octets + data.size());
    return chunk_.size() >= options_.chunk_octets ? flush() : Result<void>{};
}

Result<void> Writer::flush() {
    if (chunk_.empty()) {
        return {};
    }
    Bytes compressed;
    if (options_.compress) {
        compressed.resize(ZSTD_compressBound(chunk_.size()));
        std::size_t const size =
            ZSTD_compress(compressed.data(), compressed.size(), chunk_.data(), chunk_.size(), kLevel);
        compressed.resize(ZSTD_isError(size) != 0 ? 0 : size);
    }
    bool const zstd = !compressed.empty();
    Bytes const& stored = zstd ? compressed : chunk_;
    Bytes out, body;
    Encoder{body}
        .number(chunk_start_)
        .number(chunk_end_)
        .number(static_cast<std::uint64_t>(chunk_.size()))
        .number(checksum(chunk_))
        .text(zstd ? "zstd" : "")
        .number(static_cast<std::uint64_t>(stored.size()));
    body.insert(body.end(), stored.begin(), stored.end());
    record(out, Op::chunk, body);
    std::uint64_t const length = out.size();
    std::map<std::uint16_t, std::uint64_t> index_offsets;
    for (auto& [channel, messages] : chunk_messages_) {
        if (messages.empty()) {
            continue;
        }
        index_offsets[channel] = position_ + out.size();
        Bytes entries;
        Encoder encoder{entries};
        encoder.number(channel).number(static_cast<std::uint32_t>(messages.size() * 16));
        for (auto const& [time, offset] : messages) {
            encoder.number(time).number(offset);
        }
        record(out, Op::message_index, entries);
        messages.clear();
    }
    Bytes index;
    Encoder{index}
        .number(chunk_start_)
        .number(chunk_end_)
        .number(position_)
        .number(length)
        .numbers(index_offsets)
        .number(static_cast<std::uint64_t>(out.size() - length))
        .text(zstd ? "zstd" : "")
        .number(static_cast<std::uint64_t>(stored.size()))
        .number(static_cast<std::uint64_t>(chunk_.size()));
    record(index_, Op::chunk_index, index);
    ++chunk_count_;
    spill_index();
    chunk_.clear();
    chunk_has_messages_ = false;
    return put(out);
}

/// The index grows with the recording; so that memory does not, its older part goes into a file without a name. Where
/// that cannot be had it stays in memory.
void Writer::spill_index() {
    constexpr std::size_t kInMemory = 256 * 1024;
    if (index_.size() < kInMemory) {
        return;
    }
    if (!spilled_) {
        std::filesystem::path const folder = file_.has_parent_path() ? file_.parent_path() : ".";
        spilled_ = UniqueFd{::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600)};
    }
    std::size_t done = 0;
    while (spilled_ && done < index_.size()) {
        ssize_t const written = ::write(spilled_.get(), index_.data() + done, index_.size() - done);
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written <= 0) {
            break; // the recording itself will find the disk full, and say so
        }
        done += static_cast<std::size_t>(written);
    }
    index_.erase(index_.begin(), index_.begin() + static_cast<std::ptrdiff_t>(done));
}

Result<void> Writer::put_index() {
    if (spilled_) {
        Bytes part(256 * 1024);
        ::lseek(spilled_.get(), 0, SEEK_SET);
        while (true) {
            ssize_t const size = ::read(spilled_.get(), part.data(), part.size());
            if (size < 0 && errno == EINTR) {
                continue;
            }
            if (size < 0) {
                return fail(ExitCode::environment,
                            fmt::format("cannot finish '{}': {}", file_.string(), std::strerror(errno)));
            }
            if (size == 0) {
                break;
            }
            if (auto ok = put({part.begin(), part.begin() + size}); !ok) {
                return ok;
            }
        }
        spilled_.reset();
    }
    return put(index_);
}

Bytes Writer::statistics_body() const {
    Bytes out;
    Encoder{out}
        .number(message_count_)
        .number(static_cast<std::uint16_t>(schemas_.size()))
        .number(static_cast<std::uint32_t>(channels_.size()))
        .number(std::uint32_t{0})
        .number(std::uint32_t{0})
        .number(chunk_count_)
        .number(first_time_)
        .number(last_time_)
        .numbers(channel_counts_);
    return out;
}

Result<void> Writer::finish() {
    if (!fd_ || std::exchange(finished_, true)) {
        return {};
    }
    if (auto ok = flush(); !ok) {
        return ok;
    }
    Bytes out, body;
    Encoder{body}.number(std::uint32_t{0}); // CRC of the data section: not computed
    record(out, Op::data_end, body);
    std::uint64_t const summary_start = position_ + out.size();

    struct Group {
        Op op;
        std::uint64_t start, length;
    };
    std::vector<Group> groups;
    auto const group = [&](Op op, auto const& items, auto const& to_body) {
        std::uint64_t const start = position_ + out.size();
        for (auto const& item : items) {
            record(out, op, to_body(item));
        }
        if (position_ + out.size() != start) {
            groups.push_back({op, start, position_ + out.size() - start});
        }
    };
    group(Op::schema, schemas_, schema_body);
    group(Op::channel, channels_, channel_body);
    group(Op::statistics, std::array{0}, [&](int) { return statistics_body(); });
    if (auto ok = put(out); !ok) {
        return ok;
    }
    out.clear();
    if (std::uint64_t const start = position_; chunk_count_ > 0) {
        if (auto ok = put_index(); !ok) {
            return ok;
        }
        groups.push_back({Op::chunk_index, start, position_ - start});
    }
    std::uint64_t const offsets_start = position_ + out.size();
    for (Group const& g : groups) {
        Bytes b;
        Encoder{b}.number(static_cast<std::uint8_t>(g.op)).number(g.start).number(g.length);
        record(out, Op::summary_offset, b);
    }
    Bytes footer;
    Encoder{footer}.number(summary_start).number(offsets_start).number(std::uint32_t{0});
    record(out, Op::footer, footer);
    out.insert(out.end(), kMagic.begin(), kMagic.end());
    return put(out);
}

Result<void> Writer::close() {
    if (!fd_) {
        return {};
    }
    if (auto ok = finish(); !ok || failed_) {
        return ok;
    }
    int const synced = ::fsync(fd_.get());
    int const closed = ::close(fd_.release());
    return synced == 0 && closed == 0 ? Result<void>{}
                                      : fail(ExitCode::environment, fmt::format("cannot finish '{}': {}",
                                                                                file_.string(), std::strerror(errno)));
}

} // namespace gridspace::mcap
