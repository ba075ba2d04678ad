//! A session with a server, for reading and writing the values of nodes.
//!
//! After a [`RequestError::Lost`] the client must be dropped.

use opcua_types::{
    AttributeId, CloseSessionRequest, CloseSessionResponse, DataValue, NodeId, ReadRequest,
    ReadResponse, ReadValueId, StatusCode, SubStatusCode, TimestampsToReturn, Variant,
    WriteRequest, WriteResponse, WriteValue,
};

use super::wire::{Answer, Wire, explain};
use crate::error::LinkError;
use crate::timed_socket::SocketError;

/// Largest number of nodes per request; controllers allow some hundreds.
pub(super) const NODES: usize = 256;

/// Errors of a request.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum RequestError {
    /// The connection can no longer be used.
    Lost(LinkError),
    /// The server rejected the request.
    Refused(StatusCode),
}

/// A session.
pub(super) struct OpcUaClient {
    pub wire: Wire,
    timeout_s: f64,
    /// The present request, for the message if it is not answered.
    pub request: String,
    pub token: NodeId,
    is_lost: bool,
}

impl OpcUaClient {
    /// A client without a session.
    pub fn new(wire: Wire, timeout_s: f64) -> Self {
        Self {
            wire,
            timeout_s,
            request: "for a session".to_owned(),
            token: NodeId::null(),
            is_lost: false,
        }
    }

    pub fn ask<A: Answer>(
        &mut self,
        request: &(impl opcua_types::BinaryEncodable + opcua_types::MessageInfo),
    ) -> Result<A, RequestError> {
        let answer = self.wire.exchange(request);
        let answer = answer.map_err(|broken| self.broken(broken))?;
        answer.map_err(|status| self.refusal(status))
    }

    /// Converts a failure of the transport, which ends the connection.
    pub fn broken(&mut self, broken: SocketError) -> RequestError {
        let error = broken.into_error((&self.request, self.timeout_s), "");
        self.lost(RequestError::Lost(error))
    }

    /// Notes that the session must not be used any more.
    pub fn lost(&mut self, error: RequestError) -> RequestError {
        self.is_lost = true;
        error
    }

    /// Converts a rejection; that of the whole session ends the connection.
    pub fn refusal(&mut self, status: StatusCode) -> RequestError {
        use SubStatusCode as S;
        match status.sub_code() {
            S::BadSessionIdInvalid
            | S::BadSessionClosed
            | S::BadSessionNotActivated
            | S::BadSecureChannelIdInvalid
            | S::BadSecureChannelClosed
            | S::BadServerHalted
            | S::BadShutdown => {
                self.is_lost = true;
                let text = format!("it ended the session: {}", explain(status));
                RequestError::Lost(LinkError::Disconnected(text))
            }
            _ => RequestError::Refused(status),
        }
    }

    pub fn other_length(&mut self) -> RequestError {
        let text = "its answer is invalid: its length differs from that of the request";
        self.lost(RequestError::Lost(LinkError::Disconnected(text.to_owned())))
    }

    /// The values of nodes, in one request unless there are very many.
    pub fn read(&mut self, nodes: &[NodeId]) -> Result<Vec<DataValue>, RequestError> {
        let mut values = Vec::with_capacity(nodes.len());
        for part in nodes.chunks(NODES) {
            self.request = format!("to read {} of {} nodes", part.len(), nodes.len());
            let wanted = |node: &NodeId| ReadValueId {
                node_id: node.clone(),
                attribute_id: AttributeId::Value as u32,
                ..Default::default()
            };
            let request = ReadRequest {
                request_header: self.wire.header(&self.token),
                max_age: 0.0,
                timestamps_to_return: TimestampsToReturn::Neither,
                nodes_to_read: Some(part.iter().map(wanted).collect()),
            };
            let answer: ReadResponse = self.ask(&request)?;
            let results = answer.results.unwrap_or_default();
            if results.len() != part.len() {
                return Err(self.other_length());
            }
            values.extend(results);
        }
        Ok(values)
    }

    /// Writes the values of nodes in one request; returns the status of each.
    pub fn write(
        &mut self,
        values: Vec<(NodeId, Variant)>,
    ) -> Result<Vec<StatusCode>, RequestError> {
        let count = values.len();
        self.request = format!("to write {count} nodes");
        let written = values.into_iter().map(|(node_id, value)| WriteValue {
            node_id,
            attribute_id: AttributeId::Value as u32,
            // Many controllers reject writes with time stamps.
            value: DataValue {
                value: Some(value),
                ..DataValue::null()
            },
            ..Default::default()
        });
        let request = WriteRequest {
            request_header: self.wire.header(&self.token),
            nodes_to_write: Some(written.collect()),
        };
        let answer: WriteResponse = self.ask(&request)?;
        let results = answer.results.unwrap_or_default();
        if results.len() != count {
            return Err(self.other_length());
        }
        Ok(results)
    }
}

impl Drop for OpcUaClient {
    fn drop(&mut self) {
        if self.is_lost {
            return;
        }
        // Servers allow few sessions and would otherwise keep this one for minutes.
        let request = CloseSessionRequest {
            request_header: self.wire.header(&self.token),
            delete_subscriptions: true,
        };
        if self.ask::<CloseSessionResponse>(&request).is_ok() {
            self.wire.close();
        }
    }
}
