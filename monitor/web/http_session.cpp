// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/web/connections.hpp"

#include <fmt/format.h>

namespace gridspace::web {

HttpSession::HttpSession(ServerImpl& server, Transport&& stream) : server_{server}, stream_{std::move(stream)} {
    server_.enter(this);
}
HttpSession::~HttpSession() {
    idle(false);
    server_.leave(this);
}

void HttpSession::idle(bool yes) {
    if (yes && !idle_) {
        idle_ = server_.idle_.insert(server_.idle_.end(), this);
    } else if (!yes && idle_) {
        server_.idle_.erase(*std::exchange(idle_, std::nullopt));
    }
}

void HttpSession::start() {
    idle(true);
    if (!stream_.secure()) {
        wait_for_request();
        return;
    }
    tcp().expires_after(server_.options_.limits.request_time);
    stream_.async_handshake([self = shared_from_this()](beast::error_code error) {
        if (!error) {
            self->wait_for_request();
        }
    });
}

void HttpSession::wait_for_request() {
    idle(true);
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(server_.options_.limits.header_octets));
    parser_->body_limit(server_.options_.limits.body_octets);
    if (buffer_.size() > 0) {
        read();
        return;
    }
    tcp().expires_after(server_.options_.limits.idle_time);
    stream_.async_read_some(buffer_.prepare(4096),
                            [self = shared_from_this()](beast::error_code error, std::size_t size) {
                                if (!error) {
                                    self->buffer_.commit(size);
                                    self->read();
                                }
                            });
}

void HttpSession::read() {
    tcp().expires_after(server_.options_.limits.request_time); // one budget for the whole request: no slow loris
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
        self->keep_alive_ = false;
        self->method_ = http::verb::get;
        if (!error) {
            self->on_request();
        } else if (error == http::error::header_limit) {
            self->refuse(431, "the headers are too long", "at most 8 KiB together");
        } else if (error == http::error::body_limit) {
            self->refuse(413, "the body is too long", "at most 64 KiB");
        } else if (error == beast::error::timeout) {
            return; // the stream is closed already
        } else if (error.category() == http::make_error_code(http::error::bad_value).category() &&
                   error != http::error::end_of_stream && error != http::error::partial_message) {
            self->refuse(400, "this is not HTTP", "HTTP/1.1, or https where the monitor has a certificate");
        }
    });
}

void HttpSession::refuse(int status, char const* error, char const* remedy, std::string allow) {
    server_.count([](ServerCounters& c) { ++c.refused; });
    Response response;
    response.status = status;
    response.body = fmt::format(R"({{"error":"{}","remedy":"{}"}})", error, remedy); // neither has quotes in it
    response.allow = std::move(allow);
    keep_alive_ = keep_alive_ && status != 400 && status != 404;
    answer(std::move(response));
}

void HttpSession::on_request() {
    auto request = parser_->release();
    keep_alive_ = request.keep_alive();
    method_ = request.method();
    server_.count([](ServerCounters& c) { ++c.requests; });
    if (request.count(http::field::host) != 1 || !server_.knows_host(text_of(request[http::field::host]), tcp())) {
        return refuse(403, "this monitor does not answer to that host name",
                      "by its address, a name in its certificate, or one in allow_hosts");
    }
    std::string const origin = text_of(request[http::field::origin]);
    std::string const host = text_of(request[http::field::host]);
    if (!origin_allowed(server_.options_.sites, origin) && origin != "https://" + host && origin != "http://" + host) {
        return refuse(403, "pages of that origin may not talk to this monitor",
                      "its allow_hosts name the sites that may");
    }
    auto target = parse_target(text_of(request.target()));
    if (!target) {
        return refuse(400, "this is no plain path with a plain query",
                      "no .., no empty or dot segments, no control characters, whole %XX escapes, at most 4096 octets");
    }
    if (websocket::is_upgrade(request)) {
        return open_push(request, *target);
    }
    if (method_ != http::verb::get && method_ != http::verb::head && method_ != http::verb::post) {
        return refuse(405, "nothing here is asked for by that method", "GET, HEAD or POST", "GET, HEAD, POST");
    }
    if (server_.crowded()) {
        keep_alive_ = false;
        return refuse(503, "too many connections", "come back in a moment");
    }
    Request out;
    out.method = text_of(request.method_string());
    out.target = std::move(*target);
    out.authorization = text_of(request[http::field::authorization]);
    out.accept_encoding = text_of(request[http::field::accept_encoding]);
    out.if_none_match = text_of(request[http::field::if_none_match]);
    out.body = std::move(request.body());
    out.accept = text_of(request[http::field::accept]);
    out.cookie = text_of(request[http::field::cookie]);
    auto instead = server_.gate_.check(out);
    if (instead && instead->status == 401) {
        server_.count([](ServerCounters& c) { ++c.refused; });
    }
    if (instead) {
        return answer(std::move(*instead));
    }
    Response response;
    if (!guarded("a request", [&] { response = server_.handlers_.request(out); })) {
        return refuse(500, "this request failed", "the monitor's log says why");
    }
    answer(std::move(response));
}

void HttpSession::open_push(http::request<http::string_body> const& request, Target& target) {
    std::string const& path = target.path;
    if (!server_.gate_.admits_push(text_of(request[http::field::authorization]), text_of(request[http::field::cookie]),
                                   target)) {
        return refuse(401, "this monitor asks for a token", "Authorization: Bearer TOKEN, or ?token=TOKEN");
    }
    std::vector<std::string> offered;
    for (auto const& protocol : http::token_list{request[http::field::sec_websocket_protocol]}) {
        offered.push_back(text_of(protocol));
    }
    auto chosen = server_.handlers_.accepts_push ? server_.handlers_.accepts_push(path, offered) : std::nullopt;
    if (!chosen) {
        return refuse(404, "there is no WebSocket here", "/ws/v1, or the subprotocol foxglove.websocket.v1");
    }
    if (server_.push_clients() >= server_.options_.limits.push_clients) {
        keep_alive_ = false;
        return refuse(503, "too many WebSockets are open", "close one, or come back in a moment");
    }
    idle(false);
    std::make_shared<PushSession>(server_, std::move(stream_), server_.next_client_++)
        ->open(request, path, std::move(*chosen));
}

void HttpSession::answer(Response response) {
    idle(false);
    response_ = std::make_shared<http::response<http::string_body>>();
    auto& out = *response_;
    out.version(11);
    out.result(static_cast<unsigned>(response.status));
    out.set(http::field::content_type, response.content_type);
    out.set(http::field::cache_control, response.etag.empty() ? "no-store" : "no-cache");
    out.set("X-Content-Type-Options", "nosniff");
    out.set("Content-Security-Policy",
            "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
            "form-action 'self'; frame-ancestors 'none'");
    out.set("Referrer-Policy", "no-referrer");
    out.set("Cross-Origin-Resource-Policy", "same-origin");
    auto const set = [&](http::field field, std::string const& value) {
        if (!value.empty()) {
            out.set(field, value);
        }
    };
    set(http::field::etag, response.etag);
    set(http::field::allow, response.allow);
    set(http::field::location, response.location);
    set(http::field::set_cookie, response.set_cookie);
    set(http::field::www_authenticate, response.status == 401 ? "Bearer" : "");
    if (!response.content_encoding.empty()) {
        out.set(http::field::content_encoding, response.content_encoding);
        out.set(http::field::vary, "Accept-Encoding");
    }
    out.keep_alive(keep_alive_);
    std::size_t const size = response.body.size();
    if (method_ != http::verb::head && response.status != 304) {
        out.body() = std::move(response.body);
        out.prepare_payload();
    } else {
        out.content_length(response.status == 304 ? 0 : size);
    }
    tcp().expires_after(server_.options_.limits.response_time);
    auto const done = [self = shared_from_this()](beast::error_code error, std::size_t) {
        if (error || !self->keep_alive_) {
            self->end();
            return;
        }
        self->response_.reset();
        self->wait_for_request();
    };
    if (method_ == http::verb::head) {
        auto serializer = std::make_shared<http::response_serializer<http::string_body>>(out);
        http::async_write_header(stream_, *serializer,
                                 [done, serializer](beast::error_code error, std::size_t n) { done(error, n); });
    } else {
        http::async_write(stream_, out, done);
    }
}

void HttpSession::end() {
    beast::error_code ignored;
    if (!stream_.secure()) {
        tcp().socket().shutdown(tcp::socket::shutdown_send, ignored);
        return;
    }
    tcp().expires_after(std::chrono::seconds{2});
    stream_.async_shutdown([self = shared_from_this()](beast::error_code) {});
}

} // namespace gridspace::web
