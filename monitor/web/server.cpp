// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The only file that includes Boost (it takes half a minute to compile).
#include "monitor/web/server.hpp"

#include "common/log.hpp"

#include <atomic>
#include <boost/asio/dispatch.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <csignal>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

namespace gridspace::web {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace asio = boost::asio;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Stream = beast::tcp_stream;

class ServerImpl;

std::string text_of(beast::string_view text) {
    return {text.data(), text.size()};
}

/// A message that waits for a slow client.
struct Push {
    std::shared_ptr<std::string const> text;
    bool binary{false};
};

class Closable {
  public:
    virtual ~Closable() = default;
    virtual void close() = 0;
};

/// One WebSocket client. Everything runs on the server's thread.
class PushSession final : public Closable, public std::enable_shared_from_this<PushSession> {
  public:
    PushSession(ServerImpl& server, Stream&& stream, ClientId id)
        : server_{server}, socket_{std::move(stream)}, id_{id} {}
    ~PushSession() override;
    void open(http::request<http::string_body> const& request, std::string path, std::string protocol);
    void push(Push message);
    void close() override { beast::get_lowest_layer(socket_).close(); }
    [[nodiscard]] ClientId id() const { return id_; }

  private:
    void read();
    void write();

    ServerImpl& server_;
    websocket::stream<Stream> socket_;
    ClientId id_;
    beast::flat_buffer buffer_;
    std::deque<Push> waiting_;
    std::size_t waiting_octets_{0};
    bool writing_{false}, opened_{false}, protocol_{false};
};

/// One HTTP connection.
class HttpSession final : public Closable, public std::enable_shared_from_this<HttpSession> {
  public:
    HttpSession(ServerImpl& server, Stream&& stream);
    ~HttpSession() override;
    void start() { wait_for_request(); }
    void close() override { stream_.close(); }

  private:
    void wait_for_request();
    void read();
    void on_request();
    void answer(Response response, http::verb method, bool keep_alive);

    ServerImpl& server_;
    Stream stream_;
    beast::flat_buffer buffer_;
    std::optional<http::request_parser<http::string_body>> parser_;
    std::shared_ptr<http::response<http::string_body>> response_;
    bool moved_{false};
};

class ServerImpl final : public Server {
  public:
    ServerImpl(Options options, Handlers handlers)
        : options_{std::move(options)}, handlers_{std::move(handlers)}, acceptor_{context_} {}

    ~ServerImpl() override {
        asio::post(context_, [this] {
            ending_ = true;
            boost::system::error_code ignored;
            acceptor_.close(ignored);
            for (Closable* connection : std::set<Closable*>{connections_}) {
                connection->close();
            }
        });
        if (thread_.joinable()) {
            thread_.join(); // the context runs dry when all connections are gone
        }
    }

    Result<void> open(UniqueFd listening) {
        boost::system::error_code error;
        acceptor_.assign(tcp::v4(), listening.get(), error);
        if (error) {
            return fail(ExitCode::environment, "the socket to serve on does not work: " + error.message());
        }
        (void)listening.release();
        accept();
        thread_ = std::thread{[this] { context_.run(); }};
        return {};
    }

    void push(ClientId client, std::shared_ptr<std::string const> message, bool binary) override {
        asio::post(context_, [this, client, message = std::move(message), binary]() mutable {
            if (auto const it = clients_.find(client); it != clients_.end()) {
                it->second->push({std::move(message), binary});
            }
        });
    }
    [[nodiscard]] std::uint64_t dropped(ClientId client) const override {
        std::lock_guard const lock{mutex_};
        auto const it = dropped_.find(client);
        return it == dropped_.end() ? 0 : it->second;
    }
    [[nodiscard]] ServerCounters counters() const override {
        std::lock_guard const lock{mutex_};
        return counters_;
    }

    void accept() {
        acceptor_.async_accept([this](boost::system::error_code error, tcp::socket socket) {
            if (ending_ || error == asio::error::operation_aborted) {
                return;
            }
            if (!error) {
                if (connections_.size() >= options_.limits.connections) {
                    count([](ServerCounters& c) { ++c.refused; });
                    boost::system::error_code ignored;
                    socket.close(ignored);
                } else {
                    std::make_shared<HttpSession>(*this, Stream{std::move(socket)})->start();
                }
            }
            accept();
        });
    }

    template <class F>
    void count(F&& change) {
        std::lock_guard const lock{mutex_};
        change(counters_);
    }
    void count_drop(ClientId client) {
        std::lock_guard const lock{mutex_};
        ++counters_.dropped;
        ++dropped_[client];
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
        count([this](ServerCounters& c) { c.push_clients = clients_.size(); });
    }
    void leave_client(ClientId id) {
        clients_.erase(id);
        std::lock_guard const lock{mutex_};
        counters_.push_clients = clients_.size();
        dropped_.erase(id);
    }

    Options const options_;
    Handlers const handlers_;
    ClientId next_client_{1};

  private:
    bool ending_{false};
    std::set<Closable*> connections_;
    std::map<ClientId, PushSession*> clients_;
    mutable std::mutex mutex_; // guards the next two
    ServerCounters counters_;
    std::map<ClientId, std::uint64_t> dropped_;
    // Last, so first to go: connections that end with it still find the rest.
    asio::io_context context_{1};
    tcp::acceptor acceptor_;
    std::thread thread_;
};

PushSession::~PushSession() {
    server_.leave(this);
    if (opened_) {
        server_.leave_client(id_);
        if (server_.handlers_.closed) {
            server_.handlers_.closed(id_);
        }
    }
}

void PushSession::open(http::request<http::string_body> const& request, std::string path, std::string protocol) {
    server_.enter(this);
    beast::get_lowest_layer(socket_).expires_never();
    auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
    timeout.handshake_timeout = server_.options_.limits.request_time;
    timeout.idle_timeout = server_.options_.limits.idle_time; // answers to our pings count as life
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(server_.options_.limits.body_octets);
    protocol_ = !protocol.empty();
    if (protocol_) {
        socket_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
            response.set(http::field::sec_websocket_protocol, protocol);
        }));
    }
    socket_.async_accept(request, [self = shared_from_this(), path = std::move(path),
                                   protocol = std::move(protocol)](beast::error_code error) {
        if (error) {
            return;
        }
        self->opened_ = true;
        self->server_.enter_client(self);
        if (self->server_.handlers_.opened) {
            self->server_.handlers_.opened(self->id_, path, protocol);
        }
        self->read();
    });
}

void PushSession::read() {
    socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
        if (error) {
            self->close(); // a write that waits for the client ends too
            return;
        }
        if (self->server_.handlers_.message) {
            self->server_.handlers_.message(self->id_, beast::buffers_to_string(self->buffer_.data()));
        }
        self->buffer_.clear();
        self->read();
    });
}

void PushSession::push(Push message) {
    Limits const& limits = server_.options_.limits;
    waiting_octets_ += message.text->size();
    waiting_.push_back(std::move(message));
    // The one at the front may be on its way already.
    std::size_t const first = writing_ ? 1 : 0;
    while (waiting_.size() > first + 1 && (waiting_.size() > (protocol_ ? limits.push_samples : limits.push_messages) ||
                                           waiting_octets_ > limits.push_octets)) {
        waiting_octets_ -= waiting_[first].text->size();
        waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(first));
        server_.count_drop(id_);
    }
    if (!writing_) {
        write();
    }
}

void PushSession::write() {
    writing_ = true;
    socket_.binary(waiting_.front().binary);
    socket_.async_write(asio::buffer(*waiting_.front().text),
                        [self = shared_from_this()](beast::error_code error, std::size_t) {
                            if (error) {
                                self->close();
                                return;
                            }
                            self->server_.count([](ServerCounters& c) { ++c.pushed; });
                            self->waiting_octets_ -= self->waiting_.front().text->size();
                            self->waiting_.pop_front();
                            self->writing_ = false;
                            if (!self->waiting_.empty()) {
                                self->write();
                            }
                        });
}

HttpSession::HttpSession(ServerImpl& server, Stream&& stream) : server_{server}, stream_{std::move(stream)} {
    server_.enter(this);
}
HttpSession::~HttpSession() {
    server_.leave(this);
}

void HttpSession::wait_for_request() {
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(server_.options_.limits.header_octets));
    parser_->body_limit(server_.options_.limits.body_octets);
    if (buffer_.size() > 0) {
        read();
        return;
    }
    stream_.expires_after(server_.options_.limits.idle_time);
    stream_.async_read_some(buffer_.prepare(4096),
                            [self = shared_from_this()](beast::error_code error, std::size_t size) {
                                if (!error) {
                                    self->buffer_.commit(size);
                                    self->read();
                                }
                            });
}

void HttpSession::read() {
    stream_.expires_after(server_.options_.limits.request_time); // one budget for the whole request: no slow loris
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
        if (!error) {
            self->on_request();
        } else if (error == http::error::header_limit) {
            self->answer({431, "text/plain", "the headers are too long\n", {}, {}, {}}, http::verb::get, false);
        } else if (error == http::error::body_limit) {
            self->answer({413, "text/plain", "the body is too long\n", {}, {}, {}}, http::verb::get, false);
        } else if (error == beast::error::timeout) {
            return; // the stream is closed already
        } else if (error.category() == http::make_error_code(http::error::bad_value).category() &&
                   error != http::error::end_of_stream && error != http::error::partial_message) {
            self->answer({400, "text/plain", "this is not HTTP\n", {}, {}, {}}, http::verb::get, false);
        }
    });
}

void HttpSession::on_request() {
    auto request = parser_->release();
    bool const keep_alive = request.keep_alive();
    auto const refuse = [&](int status, std::string text, std::string allow = {}) {
        server_.count([](ServerCounters& c) { ++c.refused; });
        answer({status, "text/plain", std::move(text) + "\n", {}, {}, std::move(allow)}, request.method(),
               keep_alive && status != 400 && status != 404);
    };
    server_.count([](ServerCounters& c) { ++c.requests; });
    if (request.count(http::field::host) != 1 ||
        !host_allowed(server_.options_.sites, text_of(request[http::field::host]))) {
        return refuse(403, "this server does not answer to that host name");
    }
    if (!origin_allowed(server_.options_.sites, text_of(request[http::field::origin]))) {
        return refuse(403, "pages of that origin may not talk to this server");
    }
    auto target = parse_target(text_of(request.target()));
    if (!target) {
        return refuse(400, "the path is not a plain one");
    }
    if (websocket::is_upgrade(request)) {
        std::vector<std::string> offered;
        for (auto const& protocol : http::token_list{request[http::field::sec_websocket_protocol]}) {
            offered.push_back(text_of(protocol));
        }
        auto chosen =
            server_.handlers_.accepts_push ? server_.handlers_.accepts_push(target->path, offered) : std::nullopt;
        if (!chosen) {
            return refuse(404, "no WebSocket here");
        }
        std::make_shared<PushSession>(server_, std::move(stream_), server_.next_client_++)
            ->open(request, target->path, std::move(*chosen));
        return;
    }
    if (request.method() != http::verb::get && request.method() != http::verb::head &&
        request.method() != http::verb::post) {
        return refuse(405, "only GET, HEAD and POST", "GET, HEAD, POST");
    }
    Request out{text_of(request.method_string()),
                std::move(*target),
                text_of(request[http::field::authorization]),
                text_of(request[http::field::accept_encoding]),
                text_of(request[http::field::if_none_match]),
                std::move(request.body())};
    answer(server_.handlers_.request(out), request.method(), keep_alive);
}

void HttpSession::answer(Response response, http::verb method, bool keep_alive) {
    response_ = std::make_shared<http::response<http::string_body>>();
    auto& out = *response_;
    out.version(11);
    out.result(static_cast<unsigned>(response.status));
    out.set(http::field::content_type, response.content_type);
    out.set(http::field::cache_control, response.etag.empty() ? "no-store" : "no-cache");
    out.set("X-Content-Type-Options", "nosniff");
    out.set("Content-Security-Policy",
            "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
            "frame-ancestors 'none'");
    out.set("Referrer-Policy", "no-referrer");
    out.set("Cross-Origin-Resource-Policy", "same-origin");
    if (!response.etag.empty()) {
        out.set(http::field::etag, response.etag);
    }
    if (!response.content_encoding.empty()) {
        out.set(http::field::content_encoding, response.content_encoding);
        out.set(http::field::vary, "Accept-Encoding");
    }
    if (!response.allow.empty()) {
        out.set(http::field::allow, response.allow);
    }
    out.keep_alive(keep_alive);
    std::size_t const size = response.body.size();
    if (method != http::verb::head && response.status != 304) {
        out.body() = std::move(response.body);
        out.prepare_payload();
    } else {
        out.content_length(response.status == 304 ? 0 : size);
    }
    stream_.expires_after(server_.options_.limits.response_time);
    auto const done = [self = shared_from_this(), keep_alive](beast::error_code error, std::size_t) {
        if (error || !keep_alive) {
            beast::error_code ignored;
            self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
            return;
        }
        self->response_.reset();
        self->wait_for_request();
    };
    if (method == http::verb::head) {
        auto serializer = std::make_shared<http::response_serializer<http::string_body>>(out);
        http::async_write_header(stream_, *serializer,
                                 [done, serializer](beast::error_code error, std::size_t n) { done(error, n); });
    } else {
        http::async_write(stream_, out, done);
    }
}

} // namespace

Result<std::unique_ptr<Server>> Server::start(UniqueFd listening, Options options, Handlers handlers) {
    auto server = std::make_unique<ServerImpl>(std::move(options), std::move(handlers));
    if (auto ok = server->open(std::move(listening)); !ok) {
        return std::unexpected{ok.error()};
    }
    return server;
}

} // namespace gridspace::web
