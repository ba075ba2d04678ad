//! Messages of OPC UA over TCP: one request at a time, with its response before a deadline.
//!
//! The messages are encoded by `async-opcua-types`; their transport is implemented here, so that every length is
//! compared with its limit first and the deadline applies to whole exchanges. The security policy is None.

use std::io::Cursor;
use std::net::SocketAddr;
use std::time::{Duration, Instant};

use opcua_types::{
    BinaryDecodable, BinaryEncodable, ByteString, CloseSecureChannelRequest, ContextOwned,
    MessageInfo, MessageSecurityMode, NodeId, ObjectId, OpenSecureChannelRequest,
    OpenSecureChannelResponse, RequestHeader, ResponseHeader, SecurityTokenRequestType,
    ServiceFault, StatusCode, UAString,
};

use crate::timed_socket::{SocketError, TimedSocket};

/// Length of the header of every message (bytes): kind, continuation flag, length.
const HEADER: usize = 8;
/// Length of channel, token, chunk number and request number (bytes).
const CHUNK: usize = 16;
/// Largest accepted chunk (bytes).
const LARGEST_CHUNK: usize = 1 << 16;
/// Largest accepted response (bytes), all chunks together.
const LONGEST: usize = 1 << 21;
/// Smallest buffer that the standard allows (bytes).
const SMALLEST_BUFFER: usize = 8192;
/// Requested lifetime of a channel before it is renewed (ms).
const LIFETIME_MS: u32 = 3_600_000;
const NO_SECURITY: &str = "http://opcfoundation.org/UA/SecurityPolicy#None";

/// A response of a server.
pub(super) trait Answer: BinaryDecodable {
    const ID: ObjectId;
    fn header(&self) -> &ResponseHeader;
}

macro_rules! answers {
    ($($answer:ident $id:ident),*) => {$(
        impl Answer for opcua_types::$answer {
            const ID: ObjectId = ObjectId::$id;
            fn header(&self) -> &ResponseHeader {
                &self.response_header
            }
        }
    )*};
}
answers! {
    OpenSecureChannelResponse OpenSecureChannelResponse_Encoding_DefaultBinary,
    CreateSessionResponse CreateSessionResponse_Encoding_DefaultBinary,
    ActivateSessionResponse ActivateSessionResponse_Encoding_DefaultBinary,
    CloseSessionResponse CloseSessionResponse_Encoding_DefaultBinary,
    ReadResponse ReadResponse_Encoding_DefaultBinary,
    WriteResponse WriteResponse_Encoding_DefaultBinary
}

/// A connection with a secure channel of the policy None.
pub(super) struct Wire {
    socket: TimedSocket,
    timeout: Duration,
    context: ContextOwned,
    channel: u32,
    token: u32,
    renew_at: Instant,
    /// Number of the last chunk and of the last request.
    chunk: u32,
    request: u32,
    /// Largest chunk that the server accepts (bytes).
    largest: usize,
}

impl Wire {
    /// Connects and opens a channel.
    pub fn connect(place: SocketAddr, url: &str, timeout: Duration) -> Result<Self, SocketError> {
        let mut wire = Self {
            socket: TimedSocket::connect(place, timeout)?,
            timeout,
            context: ContextOwned::default(),
            channel: 0,
            token: 0,
            renew_at: Instant::now(),
            chunk: 0,
            request: 0,
            largest: SMALLEST_BUFFER,
        };
        wire.greet(url)?;
        wire.open(SecurityTokenRequestType::Issue)?;
        Ok(wire)
    }

    /// Negotiates the sizes of messages.
    fn greet(&mut self, url: &str) -> Result<(), SocketError> {
        let until = Instant::now() + self.timeout;
        let mut hello = Vec::new();
        for number in [
            0,
            LARGEST_CHUNK,
            LARGEST_CHUNK,
            LONGEST,
            LONGEST / SMALLEST_BUFFER,
        ] {
            hello.extend_from_slice(&(number as u32).to_le_bytes());
        }
        hello.extend(UAString::from(url).encode_to_vec(&self.context.context()));
        self.socket.send(&message(*b"HELF", &hello), until)?;
        let (kind, content) = self.receive(until)?;
        // Version, receive and send buffer, and two limits.
        if kind != *b"ACKF" || content.len() != 20 {
            return Err(SocketError::Invalid("its greeting is invalid".to_owned()));
        }
        let buffer = usize::try_from(word(&content[4..8])).unwrap_or(usize::MAX);
        self.largest = buffer.clamp(SMALLEST_BUFFER, LARGEST_CHUNK);
        Ok(())
    }

    /// Opens or renews the channel.
    fn open(&mut self, request_type: SecurityTokenRequestType) -> Result<(), SocketError> {
        let until = Instant::now() + self.timeout;
        let request = OpenSecureChannelRequest {
            request_header: self.header(&NodeId::null()),
            request_type,
            security_mode: MessageSecurityMode::None,
            client_nonce: ByteString::null(),
            requested_lifetime: LIFETIME_MS,
            ..Default::default()
        };
        let mut content = self.channel.to_le_bytes().to_vec();
        content.extend(UAString::from(NO_SECURITY).encode_to_vec(&self.context.context()));
        content.extend_from_slice(&[0xFF; 8]); // neither a certificate nor the print of one
        content.extend(self.numbers());
        content.extend(self.body(&request));
        self.socket.send(&message(*b"OPNF", &content), until)?;
        let (kind, content) = self.receive(until)?;
        if kind != *b"OPNF" {
            return Err(SocketError::Invalid(
                "it did not answer the request to open a channel".to_owned(),
            ));
        }
        let body = self.opened(&content)?;
        let answer: OpenSecureChannelResponse = self.decode(body)?.map_err(refused)?;
        let token = answer.security_token;
        (self.channel, self.token) = (token.channel_id, token.token_id);
        // Renewal well before expiry; a server may set a lifetime so short that nothing else could be sent.
        let life = Duration::from_millis(u64::from(token.revised_lifetime)).mul_f64(0.75);
        self.renew_at = Instant::now() + life.max(self.timeout);
        Ok(())
    }

    /// The body of the response to opening a channel.
    fn opened<'c>(&self, content: &'c [u8]) -> Result<&'c [u8], SocketError> {
        let short =
            || SocketError::Invalid("the answer to opening a channel is cut off".to_owned());
        let (_, mut rest) = content.split_at_checked(4).ok_or_else(short)?;
        // The policy and two certificates, each preceded by its length, which is -1 if absent.
        for _ in 0..3 {
            let (length, left) = rest.split_at_checked(4).ok_or_else(short)?;
            let length = i32::from_le_bytes(length.try_into().map_err(|_| short())?);
            let length = usize::try_from(length).unwrap_or(0);
            (_, rest) = left.split_at_checked(length).ok_or_else(short)?;
        }
        let (numbers, body) = rest.split_at_checked(8).ok_or_else(short)?;
        self.check_number(&numbers[4..])?;
        Ok(body)
    }

    /// The header of the next request.
    pub fn header(&self, authentication_token: &NodeId) -> RequestHeader {
        RequestHeader {
            authentication_token: authentication_token.clone(),
            timestamp: opcua_types::DateTime::now(),
            request_handle: self.request.wrapping_add(1),
            timeout_hint: u32::try_from(self.timeout.as_millis()).unwrap_or(u32::MAX),
            ..Default::default()
        }
    }

    /// Sends a request and returns its response, or the status that the server returned instead.
    pub fn exchange<A: Answer>(
        &mut self,
        request: &(impl BinaryEncodable + MessageInfo),
    ) -> Result<Result<A, StatusCode>, SocketError> {
        if Instant::now() > self.renew_at {
            self.open(SecurityTokenRequestType::Renew)?;
        }
        let until = Instant::now() + self.timeout;
        let body = self.body(request);
        self.send(&body, until)?;
        let answer = self.answer(until)?;
        self.decode(&answer)
    }

    /// Ends the connection; notifies the server without waiting for it.
    pub fn close(&mut self) {
        let request = CloseSecureChannelRequest {
            request_header: self.header(&NodeId::null()),
        };
        let body = self.body(&request);
        self.request = self.request.wrapping_add(1);
        let content = [self.chunk_head(), body].concat();
        let until = Instant::now() + Duration::from_millis(200);
        let _ = self.socket.send(&message(*b"CLOF", &content), until);
    }

    fn body(&self, request: &(impl BinaryEncodable + MessageInfo)) -> Vec<u8> {
        let context = self.context.context();
        let mut body = NodeId::new(0, request.type_id() as u32).encode_to_vec(&context);
        body.extend(request.encode_to_vec(&context));
        body
    }

    /// Numbers of the next chunk and request.
    fn numbers(&mut self) -> Vec<u8> {
        self.request = self.request.wrapping_add(1);
        self.next_chunk()
    }

    fn next_chunk(&mut self) -> Vec<u8> {
        self.chunk = self.chunk.wrapping_add(1);
        [self.chunk.to_le_bytes(), self.request.to_le_bytes()].concat()
    }

    fn chunk_head(&mut self) -> Vec<u8> {
        let channel = [self.channel.to_le_bytes(), self.token.to_le_bytes()].concat();
        [channel, self.next_chunk()].concat()
    }

    /// Sends a request in chunks that the server accepts.
    fn send(&mut self, body: &[u8], until: Instant) -> Result<(), SocketError> {
        self.request = self.request.wrapping_add(1);
        let parts: Vec<&[u8]> = body.chunks(self.largest - HEADER - CHUNK).collect();
        for (k, part) in parts.iter().enumerate() {
            let more = if k + 1 == parts.len() { b'F' } else { b'C' };
            let content = [&self.chunk_head(), *part].concat();
            self.socket
                .send(&message([b'M', b'S', b'G', more], &content), until)?;
        }
        Ok(())
    }

    /// The body of the response to the last request, assembled from its chunks.
    fn answer(&mut self, until: Instant) -> Result<Vec<u8>, SocketError> {
        let mut body = Vec::new();
        loop {
            let (kind, content) = self.receive(until)?;
            let [b'M', b'S', b'G', more @ (b'F' | b'C')] = kind else {
                return Err(SocketError::Invalid(match kind {
                    [b'M', b'S', b'G', b'A'] => "it aborted an answer".to_owned(),
                    _ => "a message of an unexpected kind".to_owned(),
                }));
            };
            let (head, part) = content.split_at_checked(CHUNK).ok_or_else(|| {
                SocketError::Invalid("a chunk shorter than its header".to_owned())
            })?;
            if word(&head[..4]) != self.channel {
                return Err(SocketError::Invalid(
                    "a chunk of another channel".to_owned(),
                ));
            }
            self.check_number(&head[12..])?;
            if body.len() + part.len() > LONGEST {
                return Err(SocketError::Invalid(format!(
                    "an answer of more than {LONGEST} bytes"
                )));
            }
            body.extend_from_slice(part);
            if more == b'F' {
                return Ok(body);
            }
        }
    }

    fn check_number(&self, number: &[u8]) -> Result<(), SocketError> {
        match word(number) == self.request {
            true => Ok(()),
            false => Err(SocketError::Invalid(
                "a message that does not belong to the request".to_owned(),
            )),
        }
    }

    /// The next message: its kind, and the data after the length.
    fn receive(&mut self, until: Instant) -> Result<([u8; 4], Vec<u8>), SocketError> {
        let mut header = [0; HEADER];
        self.socket.fill(&mut header, until)?;
        let [a, b, c, d, length @ ..] = header;
        let length = u32::from_le_bytes(length);
        let size = usize::try_from(length).ok();
        let size = size.filter(|size| (HEADER..=LARGEST_CHUNK).contains(size));
        let size = size.ok_or_else(|| {
            SocketError::Invalid(format!(
                "a message of {length} bytes, expected {HEADER} to {LARGEST_CHUNK}"
            ))
        })?;
        let mut content = vec![0; size - HEADER];
        self.socket.fill(&mut content, until)?;
        match [a, b, c] {
            [b'E', b'R', b'R'] => Err(self.ended(&content)),
            _ => Ok(([a, b, c, d], content)),
        }
    }

    /// The server's reason for ending the connection.
    fn ended(&self, content: &[u8]) -> SocketError {
        let Some((code, reason)) = content.split_at_checked(4) else {
            return SocketError::Invalid("an error without its code".to_owned());
        };
        let text = UAString::decode(&mut Cursor::new(reason), &self.context.context());
        let text = text.map_or(String::new(), |text| text.to_string());
        let text: String = text.chars().filter(|c| !c.is_control()).take(200).collect();
        let why = explain(StatusCode::from(word(code)));
        SocketError::Ended(match text.is_empty() {
            true => why,
            false => format!("{why}: {text}"),
        })
    }

    fn decode<A: Answer>(&self, body: &[u8]) -> Result<Result<A, StatusCode>, SocketError> {
        let context = self.context.context();
        let wrong = |_| SocketError::Invalid("its content cannot be read".to_owned());
        let mut content = Cursor::new(body);
        let kind = NodeId::decode(&mut content, &context).map_err(wrong)?;
        let is = |id: ObjectId| kind == NodeId::new(0, id as u32);
        if is(ObjectId::ServiceFault_Encoding_DefaultBinary) {
            let fault = ServiceFault::decode(&mut content, &context).map_err(wrong)?;
            return Ok(Err(fault.response_header.service_result));
        }
        if !is(A::ID) {
            return Err(SocketError::Invalid(
                "an answer to another request".to_owned(),
            ));
        }
        let answer = A::decode(&mut content, &context).map_err(wrong)?;
        if content.position() != body.len() as u64 {
            return Err(SocketError::Invalid(
                "an answer is longer than its content".to_owned(),
            ));
        }
        Ok(match answer.header().service_result {
            status if status.is_good() => Ok(answer),
            status => Err(status),
        })
    }
}

fn refused(status: StatusCode) -> SocketError {
    SocketError::Ended(explain(status))
}

/// Meaning of a status in words.
pub(super) fn explain(status: StatusCode) -> String {
    let meaning = status.sub_code().description().trim().trim_end_matches('.');
    format!("{meaning} (OPC UA {})", status.sub_code())
}

fn message(kind: [u8; 4], content: &[u8]) -> Vec<u8> {
    let length = u32::try_from(HEADER + content.len()).unwrap_or(u32::MAX);
    [&kind[..], &length.to_le_bytes(), content].concat()
}

fn word(bytes: &[u8]) -> u32 {
    bytes.try_into().map_or(u32::MAX, u32::from_le_bytes)
}
