// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/mcap/mcap_index.hpp"

#include "recorder/mcap/mcap_reader.hpp"
#include "recorder/mcap/mcap_records.hpp"

#include <algorithm>
#include <map>
#include <optional>

namespace gridspace::mcap {
namespace {

using Channels = std::map<std::uint16_t, ChannelContent>;

/// Before the data of a message: its code and length; channel, sequence, two times.
constexpr std::uint64_t kMessageHead = 9 + 22;

/// What stands in a chunk before the first message of a channel: its record, and that of its schema when it is the
/// first of that, too. The index does not say where; our writer puts them there.
class Introductions {
  public:
    void schema(std::uint16_t id, std::size_t body) { schemas_[id] = 9 + body; }
    void channel(std::uint16_t id, std::uint16_t schema, std::size_t body) { channels_[id] = {schema, 9 + body}; }
    /// Octets before the next message, which is this channel's.
    std::uint64_t take(std::uint16_t channel) {
        auto const it = channels_.find(channel);
        if (it == channels_.end()) {
            return 0;
        }
        auto const [schema, octets] = it->second;
        channels_.erase(it);
        auto const of_schema = schemas_.find(schema);
        std::uint64_t const more = of_schema == schemas_.end() ? 0 : of_schema->second;
        schemas_.erase(schema);
        return octets + more;
    }

  private:
    std::map<std::uint16_t, std::uint64_t> schemas_;
    std::map<std::uint16_t, std::pair<std::uint16_t, std::uint64_t>> channels_;
};

void note_message(ChannelContent& content, std::uint64_t time_ns) {
    content.first_ns = content.messages == 0 ? time_ns : std::min(content.first_ns, time_ns);
    content.last_ns = content.messages == 0 ? time_ns : std::max(content.last_ns, time_ns);
    ++content.messages;
}

/// Where the message indexes of a chunk are: octets from the beginning of the file, and how many.
struct IndexPlace {
    std::uint64_t from{0}, octets{0};
    std::uint64_t chunk_octets{0}; ///< of the chunk's records, decompressed
};

/// Reads the message indexes of one chunk; false when they are not what the summary says.
bool read_message_indexes(RecordFile& file, IndexPlace const& place, Channels& channels, Introductions& introductions) {
    std::vector<std::byte> body;
    std::string ignored;
    Op op{};
    std::vector<std::pair<std::uint64_t, std::uint16_t>> messages; // places in the chunk, channels
    file.go_to(place.from);
    while (file.at() < place.from + place.octets) {
        if (!file.next(op, body, ignored) || op != Op::message_index) {
            return false;
        }
        Decoder d{body};
        auto const channel = channels.find(d.number<std::uint16_t>());
        Decoder entries{d.take(d.number<std::uint32_t>())};
        if (!d.ok() || channel == channels.end()) {
            return false;
        }
        while (entries.left() > 0) {
            auto const time_ns = entries.number<std::uint64_t>();
            messages.emplace_back(entries.number<std::uint64_t>(), channel->first);
            if (!entries.ok()) {
                return false;
            }
            note_message(channel->second, time_ns);
        }
    }
    std::sort(messages.begin(), messages.end());
    if (!messages.empty()) {
        (void)introductions.take(messages.front().second);
    }
    for (std::size_t i = 0; i < messages.size(); ++i) {
        bool const last = i + 1 == messages.size();
        std::uint64_t const end = last ? place.chunk_octets : messages[i + 1].first;
        std::uint64_t const before_next = kMessageHead + (last ? 0 : introductions.take(messages[i + 1].second));
        std::uint64_t const gap = end - std::min(messages[i].first, end);
        channels[messages[i].second].octets += gap - std::min(before_next, gap);
    }
    return true;
}

IndexPlace read_index_place(Decoder& d) {
    d.number<std::uint64_t>(); // times
    d.number<std::uint64_t>();
    auto const chunk = d.number<std::uint64_t>(), length = d.number<std::uint64_t>();
    d.take(d.number<std::uint32_t>()); // the place of each channel's
    IndexPlace out{chunk + length, d.number<std::uint64_t>()};
    (void)d.text();            // compression
    d.number<std::uint64_t>(); // compressed
    out.chunk_octets = d.number<std::uint64_t>();
    return out;
}

std::optional<Content> content_by_index(RecordFile& file) {
    std::uint64_t const start = file.summary_start();
    if (start == 0) {
        return std::nullopt;
    }
    Content out;
    Channels channels;
    std::map<std::uint16_t, std::string> types;
    Introductions introductions;
    std::vector<IndexPlace> places;
    std::uint64_t index_octets = 0;
    std::optional<std::uint64_t> promised;
    std::vector<std::byte> body;
    std::string ignored;
    Op op{};
    file.go_to(start);
    while (file.next(op, body, ignored) && op != Op::footer) {
        Decoder d{body};
        if (op == Op::schema) {
            Schema schema = read_schema(d);
            introductions.schema(schema.id, body.size());
            types[schema.id] = std::move(schema.name);
        } else if (op == Op::channel) {
            Channel channel = read_channel(d);
            std::uint16_t const id = channel.id;
            introductions.channel(id, channel.schema_id, body.size());
            channels[id].channel = std::move(channel);
        } else if (op == Op::statistics) {
            promised = d.number<std::uint64_t>();
        } else if (op == Op::chunk_index) {
            places.push_back(read_index_place(d));
            index_octets += places.back().octets;
            if (places.back().octets > file.octets() ||
                index_octets > file.octets()) { // the same ones, again and again
                return std::nullopt;
            }
        }
        if (!d.ok()) {
            return std::nullopt;
        }
    }
    for (IndexPlace const& place : places) {
        if (place.from > file.octets() || !read_message_indexes(file, place, channels, introductions)) {
            return std::nullopt;
        }
    }
    for (auto& [id, content] : channels) {
        out.messages += content.messages;
        content.type = types[content.channel.schema_id];
        if (content.messages > 0) {
            out.channels.push_back(std::move(content));
        }
    }
    out.indexed = out.complete = true;
    return promised == out.messages ? std::optional{std::move(out)} : std::nullopt;
}

} // namespace

Result<Content> content_of(std::filesystem::path const& name) {
    auto file = RecordFile::open(name);
    if (!file) {
        return std::unexpected{file.error()};
    }
    if (auto content = content_by_index(*file)) {
        return std::move(*content);
    }
    Channels channels;
    auto const outcome = read_messages(name, [&](Message const& m) {
        ChannelContent& content = channels[m.channel.id];
        if (content.messages == 0) {
            content.channel = m.channel;
            content.type = m.schema.name;
        }
        note_message(content, m.time_ns);
        content.octets += m.data.size();
        return true;
    });
    if (!outcome) {
        return std::unexpected{outcome.error()};
    }
    Content out;
    for (auto& [id, content] : channels) {
        out.channels.push_back(std::move(content));
    }
    out.messages = outcome->messages;
    out.complete = outcome->complete;
    out.note = outcome->note;
    return out;
}

} // namespace gridspace::mcap
