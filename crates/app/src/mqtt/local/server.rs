//! The thread of page and messages.

use super::exchange::Exchange;
use super::session::{Role, Session};
use axum::Router;
use axum::extract::State;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::http::{HeaderMap, HeaderName, StatusCode, header};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use bytes::Bytes;
use config::topics::Topics;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream};
use tokio::runtime::{Builder, Handle, Runtime};
use tokio::sync::{mpsc, oneshot};
use tokio::time::timeout;

/// Names of this computer in a browser.
const NAMES: [&str; 3] = ["127.0.0.1", "localhost", "[::1]"];
/// Largest message of a browser: the longest command is a twentieth of it.
const LARGEST_IN: usize = 64 * 1024;
/// A client that does not take a message for this long is gone.
const SEND_PATIENCE: Duration = Duration::from_secs(5);
/// Bytes in the pipe to the link.
const PIPE: usize = 64 * 1024;
/// What a browser must not do with the page: guess its kind, show it in a frame of another page, or keep it.
const HEADERS: [(HeaderName, &str); 3] = [
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::CACHE_CONTROL, "no-store"),
];

/// Why the page cannot be served.
#[derive(Debug, thiserror::Error)]
pub enum LocalError {
    /// The port cannot be had.
    #[error(
        "the live page cannot be served on port {port} of this computer: {cause}; end what uses the port, or give \
         another one with --live-port (0: any that is free)"
    )]
    Port {
        /// The port.
        port: u16,
        /// What the system said.
        cause: io::Error,
    },
    /// The system gave no thread.
    #[error("no thread for the live page: {0}")]
    Thread(io::Error),
    /// The rig's name cannot be part of a topic.
    #[error(transparent)]
    Rig(#[from] config::topics::RigNameError),
}

/// Serves page and messages until it is dropped.
pub struct LocalServer {
    pub(super) address: SocketAddr,
    pub(super) exchange: Arc<Exchange>,
    runtime: Handle,
    /// Dropped, it ends the thread.
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

/// What every request needs.
#[derive(Clone)]
struct Site {
    page: Bytes,
    hosts: Arc<[String]>,
    exchange: Arc<Exchange>,
    commands: Arc<str>,
}

impl LocalServer {
    /// Serves the page that `page` makes for an address, for the rig of this name, on this port of the loopback
    /// address; 0 is any that is free. Start it before the loop raises its priority, which new threads would inherit.
    ///
    /// # Errors
    /// [`LocalError`]: the port is taken, the rig's name is not allowed in topics, or there is no thread.
    pub fn start(rig: &str, port: u16, page: impl FnOnce(SocketAddr) -> String) -> Result<Self, LocalError> {
        let commands = Topics::new(rig)?.commands.trim_end_matches('#').into();
        let failed = |cause| LocalError::Port { port, cause };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let runtime = Builder::new_current_thread().enable_all().build().map_err(LocalError::Thread)?;
        let (exchange, handle) = (Arc::<Exchange>::default(), runtime.handle().clone());
        let site = Site {
            page: page(address).into(),
            hosts: NAMES.iter().map(|name| format!("{name}:{}", address.port())).collect(),
            exchange: Arc::clone(&exchange),
            commands,
        };
        let (stop, stopped) = oneshot::channel();
        let run = move || serve(runtime, listener, site, stopped);
        let thread = thread::Builder::new().name("live-page".to_owned()).spawn(run).map_err(LocalError::Thread)?;
        Ok(Self { address, exchange, runtime: handle, stop: Some(stop), thread: Some(thread) })
    }

    /// Where the page is.
    #[must_use]
    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Makes connections of the rig's link.
    pub(in crate::mqtt) fn dialler(&self) -> impl Fn() -> io::Result<DuplexStream> + Send + Sync + Clone + 'static {
        let (exchange, runtime) = (Arc::clone(&self.exchange), self.runtime.clone());
        move || {
            let (near, far) = tokio::io::duplex(PIPE);
            let opened = Session::open(&exchange, Role::Rig).ok_or(io::ErrorKind::ConnectionRefused)?;
            runtime.spawn(attend_rig(far, opened));
            Ok(near)
        }
    }
}

impl Drop for LocalServer {
    fn drop(&mut self) {
        drop(self.stop.take());
        // It ends at once; a panic in it has been reported.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

fn serve(runtime: Runtime, listener: TcpListener, site: Site, stopped: oneshot::Receiver<()>) {
    runtime.block_on(async move {
        let Ok(listener) = tokio::net::TcpListener::from_std(listener) else { return };
        let router = Router::new().route("/", get(front)).with_state(site);
        tokio::select! {
            _ = axum::serve(listener, router) => {}
            _ = stopped => {}
        }
    });
    runtime.shutdown_background();
}

/// The page, or the messages of a page.
async fn front(
    State(site): State<Site>,
    headers: HeaderMap,
    socket: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Response {
    if !is_ours(&headers, &site.hosts) {
        return (StatusCode::FORBIDDEN, HEADERS, "this page is for browsers of its own computer, by its own address")
            .into_response();
    }
    let Ok(socket) = socket else { return (HEADERS, Html(site.page)).into_response() };
    let Some(opened) = Session::open(&site.exchange, Role::Visitor(site.commands)) else {
        return (StatusCode::SERVICE_UNAVAILABLE, HEADERS, "too many pages are open").into_response();
    };
    let socket = socket.protocols(["mqtt"]).max_message_size(LARGEST_IN).max_frame_size(LARGEST_IN);
    socket.on_upgrade(move |socket| attend_page(socket, opened)).into_response()
}

/// Whether a request is for a name of this computer, and of our page or of no page. Browsers send where a connection
/// comes from; a name that another web site gives to our address is none of ours.
fn is_ours(headers: &HeaderMap, hosts: &[String]) -> bool {
    let text = |name| headers.get(name).map(|value| value.to_str().unwrap_or_default());
    let known = |host: &str| hosts.iter().any(|ours| ours == host);
    let host = text(header::HOST).is_some_and(known);
    host && text(header::ORIGIN).is_none_or(|origin| origin.strip_prefix("http://").is_some_and(known))
}

/// A page's connection, until one side ends it.
async fn attend_page(mut socket: WebSocket, (mut session, mut messages): (Session, mpsc::Receiver<Bytes>)) {
    loop {
        let answer = tokio::select! {
            heard = timeout(session.patience(), socket.recv()) => match heard {
                Ok(Some(Ok(Message::Binary(bytes)))) => session.take(&bytes),
                Ok(Some(Ok(Message::Ping(_) | Message::Pong(_)))) => Ok(Bytes::new()),
                _ => return,
            },
            message = messages.recv() => match message {
                Some(message) => Ok(message),
                None => return,
            },
        };
        let Ok(answer) = answer else { return };
        if !answer.is_empty()
            && !matches!(timeout(SEND_PATIENCE, socket.send(Message::Binary(answer))).await, Ok(Ok(())))
        {
            return;
        }
    }
}

/// The connection of the rig's link, until one side ends it.
async fn attend_rig(mut pipe: DuplexStream, (mut session, mut messages): (Session, mpsc::Receiver<Bytes>)) {
    let mut chunk = [0; 4096];
    loop {
        let answer = tokio::select! {
            heard = timeout(session.patience(), pipe.read(&mut chunk)) => match heard {
                Ok(Ok(length @ 1..)) => session.take(chunk.get(..length).unwrap_or_default()),
                _ => return,
            },
            message = messages.recv() => match message {
                Some(message) => Ok(message),
                None => return,
            },
        };
        let Ok(answer) = answer else { return };
        if !matches!(timeout(SEND_PATIENCE, pipe.write_all(&answer)).await, Ok(Ok(()))) {
            return;
        }
    }
}
