// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/mcap/mcap_reader.hpp"

#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <zlib.h>
#include <zstd.h>

namespace gridspace::mcap {
namespace {

constexpr std::uint64_t kLargestRecord = 256ULL << 20U;

/// Reads little-endian numbers and texts; after a read beyond the end, ok() is false and values are 0.
class Decoder {
  public:
    explicit Decoder(std::span<std::byte const> bytes) : bytes_{bytes} {}
    template <class T> T number() {
        std::uint64_t value = 0;
        if (!need(sizeof(T))) {
            return 0;
        }
        for (std::size_t i = 0; i < sizeof(T); ++i) {
            value |= static_cast<std::uint64_t>(bytes_[at_ + i]) << (8 * i);
        }
        at_ += sizeof(T);
        return static_cast<T>(value);
    }
    std::string text() {
        std::span<std::byte const> const raw = take(number<std::uint32_t>());
        return {reinterpret_cast<char const*>(raw.data()), raw.size()};
    }
    std::map<std::string, std::string> texts() {
        Decoder inner{take(number<std::uint32_t>())};
        std::map<std::string, std::string> out;
        while (inner.ok() && inner.left() > 0) {
            std::string key = inner.text();
            out[std::move(key)] = inner.text();
        }
        ok_ = ok_ && inner.ok();
        return out;
    }
    std::span<std::byte const> take(std::uint64_t size) {
        if (!need(size)) {
            return {};
        }
        auto const out = bytes_.subspan(at_, size);
        at_ += size;
        return out;
    }
    [[nodiscard]] std::uint64_t left() const { return bytes_.size() - at_; }
    [[nodiscard]] bool ok() const { return ok_; }

  private:
    bool need(std::uint64_t size) {
        ok_ = ok_ && size <= left();
        return ok_;
    }
    std::span<std::byte const> bytes_;
    std::size_t at_{0};
    bool ok_{true};
};

class Reader {
  public:
    explicit Reader(std::function<bool(Message const&)> const& handler) : handler_{handler} {}

    /// One record. False to stop: the handler had enough, or the record is damaged (note_ says how).
    bool record(Op op, std::span<std::byte const> body) {
        Decoder d{body};
        switch (op) {
        case Op::schema: {
            Schema s{d.number<std::uint16_t>(), d.text(), d.text(), d.text()};
            return check(d, "schema") && (schemas_[s.id] = std::move(s), true);
        }
        case Op::channel: {
            Channel c{d.number<std::uint16_t>(), d.number<std::uint16_t>(), d.text(), d.text(), d.texts()};
            return check(d, "channel") && (channels_[c.id] = std::move(c), true);
        }
        case Op::message:
            return message(d);
        case Op::chunk:
            if (in_chunk_) {
                outcome.note = "a chunk inside a chunk";
                return false;
            }
            return chunk(d);
        case Op::data_end:
            data_ended_ = true;
            return false;
        default:
            return true;
        }
    }

    ReadOutcome outcome;
    bool data_ended_{false};
    bool stopped_{false};

  private:
    bool check(Decoder const& d, char const* what) {
        if (!d.ok()) {
            outcome.note = fmt::format("a {} record is damaged", what);
        }
        return d.ok();
    }

    bool message(Decoder& d) {
        auto const channel = channels_.find(d.number<std::uint16_t>());
        auto const sequence = d.number<std::uint32_t>();
        auto const time = d.number<std::uint64_t>();
        d.number<std::uint64_t>(); // publish time: the same
        if (!check(d, "message")) {
            return false;
        }
        if (channel == channels_.end()) {
            outcome.note = "a message of an unknown channel";
            return false;
        }
        static Schema const none;
        auto const schema = schemas_.find(channel->second.schema_id);
        ++outcome.messages;
        bool const go_on = handler_({channel->second, schema == schemas_.end() ? none : schema->second, sequence, time, d.take(d.left())});
        stopped_ = !go_on;
        return go_on;
    }

    bool chunk(Decoder& d) {
        d.number<std::uint64_t>(); // times
        d.number<std::uint64_t>();
        auto const size = d.number<std::uint64_t>();
        auto const crc = d.number<std::uint32_t>();
        std::string const compression = d.text();
        std::span<std::byte const> const stored = d.take(d.number<std::uint64_t>());
        if (!check(d, "chunk")) {
            return false;
        }
        if (size > kLargestRecord) {
            outcome.note = fmt::format("a chunk of {} octets", size);
            return false;
        }
        std::span<std::byte const> records = stored;
        if (compression == "zstd") {
            buffer_.resize(size);
            std::size_t const got = ZSTD_decompress(buffer_.data(), buffer_.size(), stored.data(), stored.size());
            if (ZSTD_isError(got) != 0 || got != size) {
                outcome.note = "a chunk cannot be decompressed";
                return false;
            }
            records = buffer_;
        } else if (!compression.empty()) {
            outcome.note = fmt::format("compression '{}' is not supported", compression);
            return false;
        }
        if (crc != 0 && crc != ::crc32(0, reinterpret_cast<Bytef const*>(records.data()), static_cast<uInt>(records.size()))) {
            outcome.note = "the checksum of a chunk is wrong";
            return false;
        }
        Decoder inner{records};
        in_chunk_ = true;
        bool good = true;
        while (good && inner.left() > 0) {
            auto const op = static_cast<Op>(inner.number<std::uint8_t>());
            std::span<std::byte const> const body = inner.take(inner.number<std::uint64_t>());
            good = check(inner, "chunk") && record(op, body);
        }
        in_chunk_ = false;
        return good;
    }

    std::function<bool(Message const&)> const& handler_;
    std::map<std::uint16_t, Schema> schemas_;
    std::map<std::uint16_t, Channel> channels_;
    std::vector<std::byte> buffer_;
    bool in_chunk_{false};
};

} // namespace

Result<ReadOutcome> read_messages(std::filesystem::path const& file, std::function<bool(Message const&)> const& handler) {
    std::ifstream stream{file, std::ios::binary};
    if (!stream) {
        return fail(ExitCode::usage, fmt::format("cannot read the recording '{}'", file.string()));
    }
    std::array<std::uint8_t, kMagic.size()> magic{};
    stream.read(reinterpret_cast<char*>(magic.data()), magic.size());
    if (magic != kMagic) {
        return fail(ExitCode::usage, fmt::format("'{}' is not an MCAP recording", file.string()));
    }
    Reader reader{handler};
    std::vector<std::byte> body;
    while (true) {
        std::array<std::uint8_t, 9> head{};
        stream.read(reinterpret_cast<char*>(head.data()), head.size());
        if (stream.gcount() != static_cast<std::streamsize>(head.size())) {
            reader.outcome.note = "the file ends without an index: the recorder did not finish";
            break;
        }
        std::uint64_t size = 0;
        for (std::size_t i = 0; i < 8; ++i) {
            size |= static_cast<std::uint64_t>(head[1 + i]) << (8 * i);
        }
        if (size > kLargestRecord) {
            reader.outcome.note = fmt::format("a record of {} octets: the file is damaged", size);
            break;
        }
        body.resize(size);
        stream.read(reinterpret_cast<char*>(body.data()), static_cast<std::streamsize>(size));
        if (stream.gcount() != static_cast<std::streamsize>(size)) {
            reader.outcome.note = "the last record is cut: the recorder did not finish";
            break;
        }
        if (!reader.record(static_cast<Op>(head[0]), body)) {
            break;
        }
    }
    reader.outcome.complete = reader.data_ended_ || reader.stopped_;
    return reader.outcome;
}

} // namespace gridspace::mcap
