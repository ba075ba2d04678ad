//! Messages of OPC UA over TCP: one request at a time, with its response before a deadline. Publish requests stay pending at
//! the server, which answers them when values have changed.
//!
//! The messages are encoded by `async-opcua-types`; their transport is implemented here, so that every length is
//! compared with its limit first and the deadline applies to whole exchanges. Messages are protected by [`Protection`]; without
//! one the security policy is None.

use std::collections::{BTreeMap, VecDeque};
use std::io::Cursor;
use std::net::SocketAddr;
use std::time::{Duration, Instant};

use opcua_types::{
    BinaryDecodable, BinaryEncodable, ByteString, CloseSecureChannelRequest, ContextOwned,
    MessageInfo, MessageSecurityMode, NodeId, ObjectId, OpenSecureChannelRequest,
    OpenSecureChannelResponse, RequestHeader, ResponseHeader, SecurityTokenRequestType,
    ServiceFault, StatusCode, UAString,
};

use super::protection::{OVERHEAD, Protection};
use crate::timed_socket::{SocketError, TimedSocket};

/// Length of the header of every message (bytes): kind, continuation flag, length.
pub(super) const HEADER: usize = 8;
/// Length of channel and token (bytes).
const TOKEN: usize = 8;
/// Length of chunk number and request number (bytes).
const NUMBERS: usize = 8;
/// Chunk numbers begin anew above the first of these, below the second.
const WRAPS: [u32; 2] = [u32::MAX - 1024, 1024];
/// Largest accepted chunk (bytes).
const LARGEST_CHUNK: usize = 1 << 16;
/// Largest accepted response (bytes), all chunks together.
const LONGEST: usize = 1 << 21;
/// Smallest buffer that the standard allows (bytes).
const SMALLEST_BUFFER: usize = 8192;
/// Requested lifetime of a channel before it is renewed (ms).
const LIFETIME_MS: u32 = 3_600_000;
/// Largest number of answers to publish requests that wait to be taken; the oldest in excess are dropped.
const MOST_TOLD: usize = 1024;
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
    GetEndpointsResponse GetEndpointsResponse_Encoding_DefaultBinary,
    CreateSessionResponse CreateSessionResponse_Encoding_DefaultBinary,
    ActivateSessionResponse ActivateSessionResponse_Encoding_DefaultBinary,
    CloseSessionResponse CloseSessionResponse_Encoding_DefaultBinary,
    CreateSubscriptionResponse CreateSubscriptionResponse_Encoding_DefaultBinary,
    CreateMonitoredItemsResponse CreateMonitoredItemsResponse_Encoding_DefaultBinary,
    DeleteSubscriptionsResponse DeleteSubscriptionsResponse_Encoding_DefaultBinary,
    PublishResponse PublishResponse_Encoding_DefaultBinary,
    ReadResponse ReadResponse_Encoding_DefaultBinary,
    WriteResponse WriteResponse_Encoding_DefaultBinary
}

/// A connection with a channel.
pub(super) struct Wire {
    socket: TimedSocket,
    protection: Option<Protection>,
    timeout: Duration,
    context: ContextOwned,
    channel: u32,
    token: u32,
    renew_at: Instant,
    /// Number of the last chunk and of the last request.
    chunk: u32,
    request: u32,
    /// Number of the last chunk of the server.
    received: Option<u32>,
    /// Largest chunk that the server accepts (bytes).
    largest: usize,
    /// Requests left with the server, and their answers so far.
    left: BTreeMap<u32, Vec<u8>>,
    /// Answers to them that are complete.
    told: VecDeque<Vec<u8>>,
    /// Token before the present one, under which messages in transit may have been sent.
    former_token: Option<u32>,
}

impl Wire {
    /// Connects and opens a channel; without `protection`, under the policy None.
    pub fn connect(
        place: SocketAddr,
        url: &str,
        timeout: Duration,
        protection: &mut Option<Protection>,
    ) -> Result<Self, SocketError> {
        let mut wire = Self {
            socket: TimedSocket::connect(place, timeout)?,
            protection: protection.take(),
            timeout,
            context: ContextOwned::default(),
            channel: 0,
            token: 0,
            renew_at: Instant::now(),
            chunk: 0,
            request: 0,
            received: None,
            largest: SMALLEST_BUFFER,
            left: BTreeMap::new(),
            told: VecDeque::new(),
            former_token: None,
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
        let answer = self.receive(until)?;
        // Version, receive and send buffer, and two limits.
        if kind_of(&answer) != *b"ACKF" || answer.len() != HEADER + 20 {
            return Err(SocketError::Invalid("its greeting is invalid".to_owned()));
        }
        let buffer = usize::try_from(word(&answer[12..16])).unwrap_or(usize::MAX);
        self.largest = buffer.clamp(SMALLEST_BUFFER, LARGEST_CHUNK);
        Ok(())
    }

    /// Opens or renews the channel.
    fn open(&mut self, request_type: SecurityTokenRequestType) -> Result<(), SocketError> {
        let until = Instant::now() + self.timeout;
        let (security_mode, client_nonce, opening) = match &mut self.protection {
            Some(protection) => (
                protection.mode(),
                protection.new_nonce(),
                protection.opening_head(),
            ),
            None => (MessageSecurityMode::None, ByteString::null(), unprotected()),
        };
        let request = OpenSecureChannelRequest {
            request_header: self.header(&NodeId::null()),
            request_type,
            security_mode,
            client_nonce,
            requested_lifetime: LIFETIME_MS,
            ..Default::default()
        };
        let mut head = self.channel.to_le_bytes().to_vec();
        for part in opening {
            head.extend(part.encode_to_vec(&self.context.context()));
        }
        let content = [self.numbers(), self.body(&request)].concat();
        let sealed = match &self.protection {
            Some(protection) => protection.seal_opening(*b"OPNF", &head, &content)?,
            None => message(*b"OPNF", &[head, content].concat()),
        };
        self.socket.send(&sealed, until)?;
        let mut answer = self.receive(until)?;
        while kind_of(&answer).starts_with(b"MSG") && !self.left.is_empty() {
            self.keep(&answer)?;
            answer = self.receive(until)?;
        }
        if kind_of(&answer) != *b"OPNF" {
            return Err(SocketError::Invalid(
                "it did not answer the request to open a channel".to_owned(),
            ));
        }
        let body = self.opened(&answer)?;
        let answer: OpenSecureChannelResponse = self.decode(&body)?.map_err(refused)?;
        if let Some(protection) = &mut self.protection {
            protection.derive(&answer.server_nonce)?;
        }
        let token = answer.security_token;
        self.former_token = Some(self.token);
        (self.channel, self.token) = (token.channel_id, token.token_id);
        // Renewal well before expiry; a server may set a lifetime so short that nothing else could be sent.
        let life = Duration::from_millis(u64::from(token.revised_lifetime)).mul_f64(0.75);
        self.renew_at = Instant::now() + life.max(self.timeout);
        Ok(())
    }

    /// The body of the response to opening a channel.
    fn opened(&mut self, answer: &[u8]) -> Result<Vec<u8>, SocketError> {
        let short =
            || SocketError::Invalid("the answer to opening a channel is cut off".to_owned());
        let (_, mut rest) = answer.split_at_checked(HEADER + 4).ok_or_else(short)?;
        // The policy and two certificates, each preceded by its length, which is -1 if absent.
        let mut head = [&[][..]; 3];
        for part in &mut head {
            let (length, left) = rest.split_at_checked(4).ok_or_else(short)?;
            let length = i32::from_le_bytes(length.try_into().map_err(|_| short())?);
            let length = usize::try_from(length).unwrap_or(0);
            (*part, rest) = left.split_at_checked(length).ok_or_else(short)?;
        }
        let content = match &self.protection {
            Some(protection) => {
                protection.check_opening_head(head)?;
                protection.open_opening(answer, answer.len() - rest.len())?
            }
            None => rest.to_vec(),
        };
        let (number, body) = self.body_of(&content)?;
        match number == self.request {
            true => Ok(body.to_vec()),
            false => Err(foreign()),
        }
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

    /// Sends a request that stays pending until the server has values to send.
    pub fn leave(
        &mut self,
        request: &(impl BinaryEncodable + MessageInfo),
    ) -> Result<(), SocketError> {
        if Instant::now() > self.renew_at {
            self.open(SecurityTokenRequestType::Renew)?;
        }
        let until = Instant::now() + self.timeout;
        let body = self.body(request);
        self.send(&body, until)?;
        self.left.insert(self.request, Vec::new());
        Ok(())
    }

    /// The answers to requests that were left with the server, as far as they have arrived, the oldest first.
    pub fn told<A: Answer>(&mut self) -> Result<Vec<Result<A, StatusCode>>, SocketError> {
        while !self.left.is_empty() && self.socket.has_received()? {
            let chunk = self.receive(Instant::now() + self.timeout)?;
            self.keep(&chunk)?;
        }
        let told = std::mem::take(&mut self.told);
        told.iter().map(|body| self.decode(body)).collect()
    }

    /// The protection of the channel; `None` under the policy None.
    pub fn protection(&self) -> Option<&Protection> {
        self.protection.as_ref()
    }

    /// Ends the connection; notifies the server without waiting for it.
    pub fn close(&mut self) {
        let request = CloseSecureChannelRequest {
            request_header: self.header(&NodeId::null()),
        };
        let body = self.body(&request);
        self.request = self.request.wrapping_add(1);
        let until = Instant::now() + Duration::from_millis(200);
        let _ = self.send_chunk(*b"CLOF", &body, until);
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

    /// Sends a part of a request, protected.
    fn send_chunk(
        &mut self,
        kind: [u8; 4],
        part: &[u8],
        until: Instant,
    ) -> Result<(), SocketError> {
        let head = [self.channel.to_le_bytes(), self.token.to_le_bytes()].concat();
        let content = [&self.next_chunk(), part].concat();
        let sealed = match &self.protection {
            Some(protection) => protection.seal(kind, &head, &content)?,
            None => message(kind, &[head, content].concat()),
        };
        self.socket.send(&sealed, until)
    }

    /// Sends a request in chunks that the server accepts.
    fn send(&mut self, body: &[u8], until: Instant) -> Result<(), SocketError> {
        self.request = self.request.wrapping_add(1);
        let room = self.largest - HEADER - TOKEN - NUMBERS - OVERHEAD;
        let parts: Vec<&[u8]> = body.chunks(room).collect();
        for (k, part) in parts.iter().enumerate() {
            let more = if k + 1 == parts.len() { b'F' } else { b'C' };
            self.send_chunk([b'M', b'S', b'G', more], part, until)?;
        }
        Ok(())
    }

    /// The body of the response to the last request, assembled from its chunks.
    fn answer(&mut self, until: Instant) -> Result<Vec<u8>, SocketError> {
        let present = self.request;
        self.left.insert(present, Vec::new());
        loop {
            let chunk = self.receive(until)?;
            match self.assemble(&chunk)? {
                Some((number, body)) if number == present => return Ok(body),
                Some((_, body)) => self.tell(body),
                None => {}
            }
        }
    }

    /// Keeps a chunk of an answer to a request that was left with the server.
    fn keep(&mut self, chunk: &[u8]) -> Result<(), SocketError> {
        if let Some((_, body)) = self.assemble(chunk)? {
            self.tell(body);
        }
        Ok(())
    }

    fn tell(&mut self, body: Vec<u8>) {
        if self.told.len() == MOST_TOLD {
            self.told.pop_front();
        }
        self.told.push_back(body);
    }

    /// Adds a chunk to the answer that it belongs to; returns the answer with the number of its request once it is complete.
    fn assemble(&mut self, chunk: &[u8]) -> Result<Option<(u32, Vec<u8>)>, SocketError> {
        let [b'M', b'S', b'G', more @ (b'F' | b'C')] = kind_of(chunk) else {
            return Err(SocketError::Invalid(match kind_of(chunk) {
                [b'M', b'S', b'G', b'A'] => "it aborted an answer".to_owned(),
                _ => "a message of an unexpected kind".to_owned(),
            }));
        };
        let content = self.content_of(chunk)?;
        let (number, part) = self.body_of(&content)?;
        let body = self.left.get_mut(&number).ok_or_else(foreign)?;
        if body.len() + part.len() > LONGEST {
            return Err(SocketError::Invalid(format!(
                "an answer of more than {LONGEST} bytes"
            )));
        }
        body.extend_from_slice(part);
        Ok(match more {
            b'F' => self.left.remove(&number).map(|body| (number, body)),
            _ => None,
        })
    }

    /// Numbers and body of a chunk, without its protection.
    fn content_of(&self, chunk: &[u8]) -> Result<Vec<u8>, SocketError> {
        let (head, content) = chunk
            .split_at_checked(HEADER + TOKEN)
            .ok_or_else(short_chunk)?;
        if word(&head[HEADER..HEADER + 4]) != self.channel {
            return Err(SocketError::Invalid(
                "a chunk of another channel".to_owned(),
            ));
        }
        let Some(protection) = &self.protection else {
            return Ok(content.to_vec());
        };
        match word(&head[HEADER + 4..]) {
            token if token == self.token => protection.open(chunk, HEADER + TOKEN),
            token if Some(token) == self.former_token => {
                protection.open_former(chunk, HEADER + TOKEN)
            }
            _ => Err(SocketError::Invalid("a chunk with other keys".to_owned())),
        }
    }

    /// Number of the request that a chunk answers, and the content after its numbers. Under protection the chunk number must be
    /// the next one: a repeated chunk is refused.
    fn body_of<'c>(&mut self, content: &'c [u8]) -> Result<(u32, &'c [u8]), SocketError> {
        let (numbers, body) = content.split_at_checked(NUMBERS).ok_or_else(short_chunk)?;
        let number = word(&numbers[..4]);
        let [last, begin] = WRAPS;
        let follows = |before: u32| match before {
            before if before > last && number < begin => true,
            before => before.checked_add(1) == Some(number),
        };
        if self.protection.is_some() && !self.received.is_none_or(follows) {
            let text = "a message out of its turn";
            return Err(SocketError::Invalid(text.to_owned()));
        }
        self.received = Some(number);
        Ok((word(&numbers[4..]), body))
    }

    /// The next message, with its header.
    fn receive(&mut self, until: Instant) -> Result<Vec<u8>, SocketError> {
        let mut header = [0; HEADER];
        self.socket.fill(&mut header, until)?;
        let length = word(&header[4..]);
        let size = usize::try_from(length).ok();
        let size = size.filter(|size| (HEADER..=LARGEST_CHUNK).contains(size));
        let size = size.ok_or_else(|| {
            SocketError::Invalid(format!(
                "a message of {length} bytes, expected {HEADER} to {LARGEST_CHUNK}"
            ))
        })?;
        let mut message = vec![0; size];
        message[..HEADER].copy_from_slice(&header);
        self.socket.fill(&mut message[HEADER..], until)?;
        match message.starts_with(b"ERR") {
            true => Err(self.ended(&message[HEADER..])),
            false => Ok(message),
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

/// Policy None, without certificates.
fn unprotected() -> [ByteString; 3] {
    let policy = ByteString::from(NO_SECURITY.as_bytes());
    [policy, ByteString::null(), ByteString::null()]
}

fn foreign() -> SocketError {
    SocketError::Invalid("a message that does not belong to the request".to_owned())
}

fn short_chunk() -> SocketError {
    SocketError::Invalid("a chunk shorter than its header".to_owned())
}

/// Kind and continuation flag of a message.
fn kind_of(message: &[u8]) -> [u8; 4] {
    let [a, b, c, d, ..] = *message else {
        return [0; 4];
    };
    [a, b, c, d]
}

fn message(kind: [u8; 4], content: &[u8]) -> Vec<u8> {
    let length = u32::try_from(HEADER + content.len()).unwrap_or(u32::MAX);
    [&kind[..], &length.to_le_bytes(), content].concat()
}

fn word(bytes: &[u8]) -> u32 {
    bytes.try_into().map_or(u32::MAX, u32::from_le_bytes)
}
