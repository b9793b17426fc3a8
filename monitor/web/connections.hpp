// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Includes Boost: for the files of this folder alone (each takes half a minute to compile).
#pragma once

#include "common/log.hpp"
#include "monitor/web/gate.hpp"
#include "monitor/web/guarded.hpp"
#include "monitor/web/server.hpp"
#include "monitor/web/transport.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>

namespace gridspace::web {

namespace beast = boost::beast;
namespace http = beast::http;
namespace asio = boost::asio;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;

class ServerImpl;

inline std::string text_of(beast::string_view text) {
    return {text.data(), text.size()};
}

class Closable {
  public:
    virtual ~Closable() = default;
    virtual void close() = 0;
};

/// One WebSocket client. Everything runs on the server's thread.
class PushSession final : public Closable, public std::enable_shared_from_this<PushSession> {
  public:
    PushSession(ServerImpl& server, Transport&& stream, ClientId id)
        : server_{server}, socket_{std::move(stream)}, id_{id} {}
    ~PushSession() override;
    void open(http::request<http::string_body> const& request, std::string path, std::string protocol);
    void push(Message message);
    void close() override { beast::get_lowest_layer(socket_).close(); }
    [[nodiscard]] ClientId id() const { return id_; }
    [[nodiscard]] bool has_sent_everything() const { return waiting_.empty(); }

  private:
    void read();
    void write();

    ServerImpl& server_;
    websocket::stream<Transport> socket_;
    ClientId id_;
    beast::flat_buffer buffer_;
    std::deque<Message> waiting_;
    std::size_t waiting_octets_{0};
    bool writing_{false}, opened_{false}, protocol_{false};
};

/// One HTTP connection.
class HttpSession final : public Closable, public std::enable_shared_from_this<HttpSession> {
  public:
    HttpSession(ServerImpl& server, Transport&& stream);
    ~HttpSession() override;
    void start();
    void close() override {
        idle(false);
        tcp().close();
    }

  private:
    [[nodiscard]] beast::tcp_stream& tcp() { return beast::get_lowest_layer(stream_); }
    void wait_for_request();
    void read();
    void on_request();
    void open_push(http::request<http::string_body> const& request, Target& target);
    void refuse(int status, char const* error, char const* remedy, std::string allow = {});
    void answer(Response response);
    void end();
    /// Idle connections are the first to go when there are too many.
    void idle(bool yes);

    ServerImpl& server_;
    Transport stream_;
    beast::flat_buffer buffer_;
    std::optional<http::request_parser<http::string_body>> parser_;
    std::shared_ptr<http::response<http::string_body>> response_;
    http::verb method_{http::verb::get};
    bool keep_alive_{false};
    std::optional<std::list<HttpSession*>::iterator> idle_;
};

/// The server: who is connected. Everything but what Server declares runs on its own thread.
class ServerImpl final : public Server {
  public:
    ServerImpl(Options options, Handlers handlers, Gate gate, std::optional<asio::ssl::context> tls);
    ~ServerImpl() override;
    [[nodiscard]] Result<void> open(UniqueFd listening);
    void push(ClientId client, Message message) override;
    void drain(std::chrono::milliseconds patience) override;
    [[nodiscard]] std::uint64_t dropped(ClientId client) const override {
        std::lock_guard const lock{mutex_};
        auto const it = tallies_.find(client);
        return it == tallies_.end() ? 0 : it->second.dropped;
    }
    [[nodiscard]] Waiting waiting(ClientId client) const override {
        std::lock_guard const lock{mutex_};
        auto const it = tallies_.find(client);
        return it == tallies_.end() ? Waiting{} : it->second.waiting;
    }
    [[nodiscard]] ServerCounters counters() const override {
        std::lock_guard const lock{mutex_};
        return counters_;
    }

    template <class F>
    void count(F&& change) {
        std::lock_guard const lock{mutex_};
        change(counters_);
    }
    /// A message of so many octets has left the client's queue.
    void count_out(ClientId client, std::size_t octets, bool lost) {
        std::lock_guard const lock{mutex_};
        Tally& tally = tallies_[client];
        --tally.waiting.messages;
        tally.waiting.octets -= octets;
        tally.dropped += lost ? 1 : 0;
        ++(lost ? counters_.dropped : counters_.pushed);
    }
    void enter(Closable* connection) {
        connections_.insert(connection);
        count([this](ServerCounters& c) { c.connections = connections_.size(); });
    }
    void leave(Closable* connection) {
        connections_.erase(connection);
        count([this](ServerCounters& c) { c.connections = connections_.size(); });
    }
    void enter_client(std::shared_ptr<PushSession> const& client) {
        clients_[client->id()] = client.get();
        std::lock_guard const lock{mutex_};
        counters_.push_clients = clients_.size();
        tallies_.try_emplace(client->id());
    }
    void leave_client(ClientId id) {
        clients_.erase(id);
        std::lock_guard const lock{mutex_};
        counters_.push_clients = clients_.size();
        tallies_.erase(id);
    }

    [[nodiscard]] std::size_t push_clients() const { return clients_.size() + opening_; }
    [[nodiscard]] bool crowded() const { return connections_.size() > options_.limits.connections; }
    /// One of the names of this server, or the address to which this connection was made.
    [[nodiscard]] bool knows_host(std::string const& host, beast::tcp_stream const& connection) const {
        boost::system::error_code error;
        auto const local = connection.socket().local_endpoint(error);
        return host_allowed(options_.sites, host) || (!error && host_allowed({{local.address().to_string()}}, host));
    }

    Options const options_;
    Handlers const handlers_;
    Gate const gate_;
    ClientId next_client_{1};
    std::list<HttpSession*> idle_; ///< longest first
    std::size_t opening_{0};       ///< WebSockets whose handshake is under way

  private:
    struct Tally {
        std::uint64_t dropped{0};
        Waiting waiting;
    };
    void accept();
    void serve();

    std::optional<asio::ssl::context> tls_;
    bool ending_{false};
    std::set<Closable*> connections_;
    std::map<ClientId, PushSession*> clients_;
    mutable std::mutex mutex_; // guards the next two
    ServerCounters counters_;
    std::map<ClientId, Tally> tallies_;
    // Last, so first to go: connections that end with it still find the rest.
    asio::io_context context_{1};
    tcp::acceptor acceptor_;
    std::thread thread_;
};

} // namespace gridspace::web
