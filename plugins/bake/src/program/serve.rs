use std::path::Path;

use anstream::{eprintln, println};
use tiny_http::{Header, Method, Request, Response, Server, StatusCode};
use veduta_store::{DirReader, INDEX_NAME, ReadError, Reader};

use super::Failure;

/// Largest file that is served, bytes.
const LARGEST: u64 = 256 << 20;

/// Serves a city on the loopback address until it is stopped.
pub(crate) fn serve(city: &Path, port: u16) -> Result<(), Failure> {
    let reader = DirReader::new(city)?;
    reader.read(INDEX_NAME, LARGEST)?;
    let server = Server::http(("127.0.0.1", port)).map_err(|e| format!("port {port}: {e}"))?;
    println!("http://{} serves {}", server.server_addr(), city.display());
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                while let Ok(request) = server.recv() {
                    answer(&reader, request);
                }
            });
        }
    });
    Ok(())
}

fn answer(reader: &DirReader, request: Request) {
    let path = request.url().split('?').next().unwrap_or("").trim_start_matches('/').to_owned();
    let head = *request.method() == Method::Head;
    if !head && *request.method() != Method::Get {
        return finish(request.respond(Response::empty(405)));
    }
    match reader.read(&path, LARGEST) {
        Ok(bytes) => {
            // Blobs are named by their content and never change; the index must be asked for anew.
            let cache = if path.starts_with("blobs/") { "public, max-age=31536000, immutable" } else { "no-cache" };
            let data = if head { Vec::new() } else { bytes };
            let mut response = Response::from_data(data).with_status_code(StatusCode(200));
            for (name, value) in
                [("Cache-Control", cache), ("Content-Type", "application/octet-stream"), ("Access-Control-Allow-Origin", "*")]
            {
                if let Ok(header) = Header::from_bytes(name, value) {
                    response.add_header(header);
                }
            }
            finish(request.respond(response));
        }
        Err(error) => {
            let code = if matches!(error, ReadError::NotFound { .. }) { 404 } else { 400 };
            finish(request.respond(Response::from_string(error.to_string()).with_status_code(code)));
        }
    }
}

/// A visitor who hangs up early is no reason to stop.
fn finish(sent: std::io::Result<()>) {
    if let Err(error) = sent {
        eprintln!("{error}");
    }
}
