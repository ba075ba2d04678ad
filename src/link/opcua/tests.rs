//! A server that misbehaves, written from the protocol: its messages make the client neither wait, nor allocate, nor panic.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

use opcua_types::{
    BinaryDecodable, BinaryEncodable, ContextOwned, OpenSecureChannelRequest, ReadRequest,
    ReadResponse, StatusCode,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tautline_session::{OpcUaPolicy, OpcUaSecurity};

use super::protection::Protection;
use super::testing::{self, certificate_of};
use super::wire::Wire;
use crate::timed_socket::SocketError;

const CHANNEL: u32 = 9;

fn message(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let length = (8 + content.len()) as u32;
    [&kind[..], &length.to_le_bytes(), content].concat()
}

/// The header of every response: time, handle and status, without diagnostics.
fn head(status: u32) -> Vec<u8> {
    let mut head = vec![0; 12];
    head.extend_from_slice(&status.to_le_bytes());
    head.extend_from_slice(&[0, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0]);
    head
}

/// The answer to request 1, which opens the channel.
fn opened() -> Vec<u8> {
    let policy = b"http://opcfoundation.org/UA/SecurityPolicy#None";
    let mut content = CHANNEL.to_le_bytes().to_vec();
    content.extend_from_slice(&(policy.len() as u32).to_le_bytes());
    content.extend_from_slice(policy);
    content.extend_from_slice(&[0xFF; 8]);
    for number in [1_u32, 1] {
        content.extend_from_slice(&number.to_le_bytes());
    }
    content.extend_from_slice(&[1, 0, 0xC1, 1]); // node 449
    content.extend(head(0));
    for number in [0, CHANNEL, 5, 0, 0, 3_600_000] {
        content.extend_from_slice(&number.to_le_bytes());
    }
    content.extend_from_slice(&[0xFF; 4]);
    message(b"OPNF", &content)
}

/// A chunk of the answer to a request.
fn chunk(kind: &[u8; 4], request: u32, body: &[u8]) -> Vec<u8> {
    let numbers = [CHANNEL, 5, 2, request].map(u32::to_le_bytes).concat();
    message(kind, &[&numbers, body].concat())
}

/// The answer to reading: one number.
fn read(request: u32) -> Vec<u8> {
    let mut body = vec![1, 0, 0x7A, 2]; // node 634
    body.extend(head(0));
    body.extend_from_slice(&1_u32.to_le_bytes());
    body.extend_from_slice(&[1, 11]); // a value, which is a Double
    body.extend_from_slice(&2.5_f64.to_le_bytes());
    body.extend_from_slice(&[0xFF; 4]);
    chunk(b"MSGF", request, &body)
}

fn take(socket: &mut TcpStream) -> Option<()> {
    let mut header = [0; 8];
    socket.read_exact(&mut header).ok()?;
    let length = u32::from_le_bytes(header[4..].try_into().ok()?);
    socket.read_exact(&mut vec![0; length as usize - 8]).ok()
}

/// Result of a read from a server that answers the greeting, the opening and the request with these messages in turn, the
/// last one byte by byte if `drips`, and then falls silent.
fn asked(
    says: Vec<Vec<u8>>,
    drips: bool,
    timeout_ms: u64,
) -> Result<Result<ReadResponse, StatusCode>, SocketError> {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let place = listener.local_addr().expect("an address");
    let server = std::thread::spawn(move || {
        let (mut socket, _) = listener.accept().expect("a client");
        let last = says.len();
        for (k, bytes) in says.into_iter().enumerate() {
            if take(&mut socket).is_none() {
                return;
            }
            for part in bytes.chunks(if drips && k + 1 == last {
                1
            } else {
                usize::MAX
            }) {
                if socket.write_all(part).is_err() {
                    return;
                }
                if part.len() == 1 {
                    std::thread::sleep(Duration::from_millis(50));
                }
            }
        }
        // Until the other side has gone.
        let _ = socket.read_to_end(&mut Vec::new());
    });
    let timeout = Duration::from_millis(timeout_ms);
    let told = Wire::connect(place, "opc.tcp://127.0.0.1", timeout, &mut None)
        .and_then(|mut wire| wire.exchange::<ReadResponse>(&ReadRequest::default()));
    server.join().expect("a server");
    told
}

fn greeting() -> Vec<u8> {
    message(
        b"ACKF",
        &[0_u32, 65536, 65536, 0, 0].map(u32::to_le_bytes).concat(),
    )
}

fn invalid(says: Vec<Vec<u8>>) -> String {
    match asked(says, false, 20_000) {
        Err(SocketError::Invalid(what)) => what,
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_answer_is_read_in_one_chunk_or_in_several() {
    let whole = read(2);
    let answer = asked(vec![greeting(), opened(), whole.clone()], false, 20_000);
    let expected = answer.expect("an answer").expect("values").results;
    assert_eq!(expected.as_ref().map(Vec::len), Some(1));
    let body = &whole[24..];
    let several = [chunk(b"MSGC", 2, &body[..7]), chunk(b"MSGF", 2, &body[7..])].concat();
    let answer = asked(vec![greeting(), opened(), several], false, 20_000);
    assert_eq!(
        answer.expect("an answer").expect("values").results,
        expected
    );
}

#[test]
fn lengths_of_messages_are_checked_before_anything_is_allocated() {
    for length in [0, 7, 65537, 1 << 30, u32::MAX] {
        for before in [vec![], vec![greeting()], vec![greeting(), opened()]] {
            let mut says = before;
            says.push([&b"MSGF"[..], &length.to_le_bytes()].concat());
            assert!(invalid(says).contains("expected 8 to 65536"), "{length}");
        }
    }
    // Chunk after chunk, without an end.
    let endless = chunk(b"MSGC", 2, &[0; 60_000]).repeat(40);
    let told = invalid(vec![greeting(), opened(), endless]);
    assert!(told.contains("an answer of more than"), "{told}");
}

#[test]
fn messages_of_others_are_refused() {
    for (says, why) in [
        (chunk(b"MSGF", 3, &[]), "does not belong to the request"),
        (chunk(b"MSGA", 2, &[]), "aborted an answer"),
        (chunk(b"OPNF", 2, &[]), "of an unexpected kind"),
        (message(b"MSGF", &[0; 3]), "shorter than its header"),
        (chunk(b"MSGF", 2, &read(2)[24..40]), "cannot be read"),
        (
            chunk(b"MSGF", 2, &[&read(2)[24..], &[0]].concat()),
            "longer than its content",
        ),
        (chunk(b"MSGF", 2, &opened()[79..]), "to another request"),
    ] {
        let told = invalid(vec![greeting(), opened(), says]);
        assert!(told.contains(why), "{told} lacks {why}");
    }
    let told = invalid(vec![b"SSH-2.0-OpenSSH_9.2p1\r\n".to_vec()]);
    assert!(told.contains("bytes, expected"), "{told}");
}

#[test]
fn a_server_says_why_it_ends_the_connection() {
    let mut content = 0x8085_0000_u32.to_le_bytes().to_vec();
    content.extend_from_slice(&4_u32.to_le_bytes());
    content.extend_from_slice(b"no\x1b!");
    let told = asked(vec![message(b"ERRF", &content)], false, 20_000);
    let Err(SocketError::Ended(why)) = told else {
        panic!("{told:?}");
    };
    assert!(
        why.contains("OPC UA Bad") && why.ends_with(": no!"),
        "{why}"
    );
}

#[test]
fn every_exchange_ends_in_time() {
    for before in [vec![], vec![greeting()], vec![greeting(), opened()]] {
        let mut says = before;
        says.push(read(2).repeat(20));
        let begun = Instant::now();
        assert!(matches!(
            asked(says, true, 300),
            Err(SocketError::Late | SocketError::Invalid(_))
        ));
        assert!(begun.elapsed() < Duration::from_secs(10));
    }
}

/// Any byte of an answer may be damaged.
#[test]
fn damaged_answers_are_errors_or_values() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let whole = read(2);
    for _ in 0..300 {
        let mut damaged = whole.clone();
        for _ in 0..rng.random_range(1..4) {
            let at = rng.random_range(24..damaged.len());
            damaged[at] = rng.random();
        }
        // Whatever the result, the read ends at once without a panic.
        let told = asked(vec![greeting(), opened(), damaged], false, 20_000);
        assert!(!matches!(told, Err(SocketError::Late)), "{told:?}");
    }
}

/// Misbehaviour of a server with protection.
#[derive(Clone, Copy, PartialEq)]
enum Wrong {
    Nothing,
    /// It answers the opening without protection.
    OpenedBare,
    /// It answers the request without protection.
    AnsweredBare,
    /// It sends the number of a chunk again.
    Repeated,
    /// It leaves a number out.
    Skipped,
    /// It names other keys.
    OtherKeys,
}

/// A received message.
fn taken(socket: &mut TcpStream) -> Vec<u8> {
    let mut message = vec![0; 8];
    socket.read_exact(&mut message).expect("a message");
    let length = u32::from_le_bytes(message[4..].try_into().expect("a length"));
    message.resize(length as usize, 0);
    socket.read_exact(&mut message[8..]).expect("a message");
    message
}

/// Offset of the encrypted part of a message that opens a channel.
fn sealed_at(message: &[u8]) -> usize {
    let mut at = 12;
    for _ in 0..3 {
        let length = message[at..at + 4].try_into().expect("a length");
        at += 4 + u32::from_le_bytes(length) as usize;
    }
    at
}

/// Serves one opening and one read.
fn serve_protected(mut socket: TcpStream, wrong: Wrong) {
    let policy = OpcUaPolicy::Basic256Sha256;
    let client = certificate_of(&testing::client());
    let security = OpcUaSecurity::SignAndEncrypt;
    let mut protection = Protection::new(security, policy, testing::server(), client);
    taken(&mut socket);
    socket.write_all(&greeting()).expect("sent");
    let opening = taken(&mut socket);
    if wrong == Wrong::OpenedBare {
        let _ = socket.write_all(&opened());
        return;
    }
    let content = protection
        .open_opening(&opening, sealed_at(&opening))
        .expect("content");
    // Numbers and the identifier of the type come before the request.
    let context = ContextOwned::default();
    let request = OpenSecureChannelRequest::decode(&mut &content[12..], &context.context());
    let nonce = protection.new_nonce();
    let request = request.expect("a request");
    protection.derive(&request.client_nonce).expect("keys");
    let mut head = CHANNEL.to_le_bytes().to_vec();
    for part in protection.opening_head() {
        head.extend(part.encode_to_vec(&context.context()));
    }
    let mut content = [1_u32, 1].map(u32::to_le_bytes).concat();
    content.extend_from_slice(&[1, 0, 0xC1, 1]); // node 449
    content.extend(self::head(0));
    for number in [0, CHANNEL, 5, 0, 0, 3_600_000] {
        content.extend_from_slice(&number.to_le_bytes());
    }
    content.extend(nonce.encode_to_vec(&context.context()));
    let answer = protection.seal_opening(*b"OPNF", &head, &content);
    socket.write_all(&answer.expect("sealed")).expect("sent");
    let asked = taken(&mut socket);
    protection.open(&asked, 16).expect("a request");
    let (token, number) = match wrong {
        Wrong::Repeated => (5, 1),
        Wrong::Skipped => (5, 3),
        Wrong::OtherKeys => (6, 2),
        _ => (5, 2_u32),
    };
    let plain = read(2);
    let answer = match wrong {
        Wrong::AnsweredBare => plain,
        _ => {
            let head = [CHANNEL, token].map(u32::to_le_bytes).concat();
            let content = [&number.to_le_bytes(), &plain[20..]].concat();
            protection.seal(*b"MSGF", &head, &content).expect("sealed")
        }
    };
    let _ = socket.write_all(&answer);
    let _ = socket.read_to_end(&mut Vec::new());
}

#[test]
fn only_protected_answers_in_their_turn_are_believed() {
    for (wrong, why) in [
        (Wrong::Nothing, None),
        (Wrong::OpenedBare, Some("by the policy that was asked for")),
        (Wrong::AnsweredBare, Some("cannot be decrypted")),
        (Wrong::Repeated, Some("out of its turn")),
        (Wrong::Skipped, Some("out of its turn")),
        (Wrong::OtherKeys, Some("with other keys")),
    ] {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let place = listener.local_addr().expect("an address");
        let server = std::thread::spawn(move || {
            let (socket, _) = listener.accept().expect("a client");
            serve_protected(socket, wrong);
        });
        let mut protection = Some(Protection::new(
            OpcUaSecurity::SignAndEncrypt,
            OpcUaPolicy::Basic256Sha256,
            testing::client(),
            certificate_of(&testing::server()),
        ));
        let timeout = Duration::from_secs(20);
        let told = Wire::connect(place, "opc.tcp://127.0.0.1", timeout, &mut protection)
            .and_then(|mut wire| wire.exchange::<ReadResponse>(&ReadRequest::default()));
        match (why, told) {
            (None, told) => {
                let values = told.expect("an answer").expect("values").results;
                assert_eq!(values.map(|values| values.len()), Some(1));
            }
            (Some(why), Err(SocketError::Invalid(told))) => {
                assert!(told.contains(why), "{told} lacks {why}");
            }
            (Some(why), told) => panic!("{why}: {told:?}"),
        }
        server.join().expect("a server");
    }
}
