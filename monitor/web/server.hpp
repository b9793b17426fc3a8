// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/unique_fd.hpp"
#include "monitor/web/listening.hpp"
#include "monitor/web/request_rules.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::web {

struct Request {
    std::string method; ///< GET, HEAD or POST
    Target target;
    std::string authorization;   ///< header, empty when there is none
    std::string accept_encoding; ///< header
    std::string if_none_match;   ///< header
    std::string body;
    std::string accept; ///< header
    std::string cookie; ///< header
};

struct Response {
    int status{200};
    std::string content_type{"application/json"};
    std::string body;
    std::string etag;             ///< empty: not to be cached
    std::string content_encoding; ///< "gzip" when the body is that
    std::string allow;            ///< of a 405
    std::string location;         ///< of a 303
    std::string set_cookie;
};

/// Limits of a server. A client that asks for more is refused or dropped; no other client notices.
struct Limits {
    std::size_t connections{256};
    std::size_t push_clients{96}; ///< of these connections
    std::size_t header_octets{8 * 1024};
    std::size_t body_octets{64 * 1024};
    std::size_t push_octets{4 * 1024 * 1024}; ///< per WebSocket client that does not read; then the oldest are dropped
    std::size_t push_messages{32};            ///< of the same
    std::size_t push_samples{4096};           ///< of a client with a subprotocol, which gets every sample by itself
    std::chrono::seconds request_time{5};     ///< from the first octet to the last
    std::chrono::seconds idle_time{60};       ///< between two requests
    std::chrono::seconds response_time{10};   ///< a client that takes longer to read is dropped
};

using ClientId = std::uint64_t;

/// What a WebSocket client is sent.
struct Message {
    std::shared_ptr<std::string const> octets;
    bool binary{false};
    bool lasting{false}; ///< nothing later says the same again: it is never dropped
};

/// Called on the server's thread: must answer at once. What they throw ends one request or one client, nothing else.
struct Handlers {
    std::function<Response(Request const&)> request;
    /// A WebSocket may be opened there: the subprotocol that is chosen among those offered, or an empty one for none.
    std::function<std::optional<std::string>(std::string const& path, std::vector<std::string> const& offered)>
        accepts_push;
    std::function<void(ClientId, std::string const& path, std::string const& protocol)> opened;
    std::function<void(ClientId, std::string const& text)> message;
    std::function<void(ClientId)> closed;
};

/// What a WebSocket client has been sent and has not taken yet.
struct Waiting {
    std::size_t messages{0}, octets{0};
};

struct ServerCounters {
    std::uint64_t requests{0}, refused{0}, connections{0}, push_clients{0}, pushed{0}, dropped{0};
};

/// What the server shows to prove who it is (PEM).
struct TlsFiles {
    std::filesystem::path certificate; ///< its own first, then those that vouch for it
    std::filesystem::path key;
};

/// An HTTP/1.1 and WebSocket server on one thread, with TLS or without. All of Boost is behind this class.
class Server {
  public:
    struct Options {
        Sites sites;
        Limits limits;
        std::vector<std::string> tokens; ///< whoever knows one of them may ask; none: everybody may
        std::optional<TlsFiles> tls;
    };
    /// Takes a socket that listens already. One that can be reached from other machines is taken only with a token and
    /// TLS.
    [[nodiscard]] static Result<std::unique_ptr<Server>> start(UniqueFd listening, Options options, Handlers handlers);
    virtual ~Server() = default; ///< closes all connections and ends the thread

    /// Sends to a WebSocket client, from any thread. When the client does not keep up, its oldest waiting messages go;
    /// when those that must stay are too much by themselves, the client does.
    virtual void push(ClientId client, Message message) = 0;
    /// Messages that this client has lost so far.
    [[nodiscard]] virtual std::uint64_t dropped(ClientId client) const = 0;
    /// From any thread, at once; counts what push() was given before.
    [[nodiscard]] virtual Waiting waiting(ClientId client) const = 0;
    [[nodiscard]] virtual ServerCounters counters() const = 0;
    /// Waits until what was pushed is on its way to the clients, or for as long as that.
    virtual void drain(std::chrono::milliseconds /*patience*/) {}
};

} // namespace gridspace::web
