//! A session with a server, for reading and writing the values of nodes.
//!
//! After a [`RequestError::Lost`] the client must be dropped.

use opcua_types::{
    ActivateSessionRequest, ActivateSessionResponse, AnonymousIdentityToken,
    ApplicationDescription, ApplicationType, AttributeId, CloseSessionRequest,
    CloseSessionResponse, CreateSessionRequest, CreateSessionResponse, DataValue, ExtensionObject,
    MessageSecurityMode, NodeId, ReadRequest, ReadResponse, ReadValueId, StatusCode, SubStatusCode,
    TimestampsToReturn, UAString, UserTokenType, Variant, WriteRequest, WriteResponse, WriteValue,
};

use super::address::OpcUaAddress;
use super::options::OpcUaOptions;
use super::wire::{Answer, Wire, explain};
use crate::error::LinkError;
use crate::timed_socket::{SocketError, addresses_of, timeout_of};

/// Largest number of nodes per request; controllers allow some hundreds.
const NODES: usize = 256;
/// Time for which the server keeps an idle session (ms).
const SESSION_MS: f64 = 300_000.0;
const NAME: &str = "Tautline";

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
    wire: Wire,
    timeout_s: f64,
    /// The present request, for the message if it is not answered.
    request: String,
    token: NodeId,
    is_lost: bool,
}

impl OpcUaClient {
    /// Connects and creates an anonymous session.
    pub fn open(address: &OpcUaAddress, options: OpcUaOptions) -> Result<Self, LinkError> {
        let timeout = timeout_of(options.timeout_s)?;
        let url = address.to_string();
        let mut last = None;
        for place in addresses_of(&address.host, address.port)? {
            match Wire::connect(place, &url, timeout) {
                Ok(wire) => {
                    let mut client = Self {
                        wire,
                        timeout_s: options.timeout_s,
                        request: "for a session".to_owned(),
                        token: NodeId::null(),
                        is_lost: false,
                    };
                    client.begin(&url)?;
                    return Ok(client);
                }
                Err(SocketError::Invalid(what)) => {
                    last = Some(LinkError::Disconnected(format!(
                        "the server at {place} does not speak OPC UA ({what})"
                    )));
                }
                Err(SocketError::Io(error)) => {
                    let text = format!("{place} cannot be reached ({error})");
                    last = Some(LinkError::Disconnected(text));
                }
                Err(broken) => {
                    let request = ("for a connection", options.timeout_s);
                    last = Some(broken.into_error(request, ""));
                }
            }
        }
        let none = || LinkError::Disconnected(format!("{url} has no address"));
        Err(last.unwrap_or_else(none))
    }

    fn begin(&mut self, url: &str) -> Result<(), LinkError> {
        let to_error = |error| match error {
            RequestError::Lost(error) => error,
            RequestError::Refused(status) => LinkError::Refused(explain(status)),
        };
        let application = ApplicationDescription {
            application_uri: UAString::from("urn:tautline"),
            product_uri: UAString::from("urn:tautline"),
            application_name: NAME.into(),
            application_type: ApplicationType::Client,
            ..Default::default()
        };
        let request = CreateSessionRequest {
            request_header: self.wire.header(&NodeId::null()),
            client_description: application,
            endpoint_url: UAString::from(url),
            session_name: UAString::from(NAME),
            requested_session_timeout: SESSION_MS,
            ..Default::default()
        };
        let created: CreateSessionResponse = self.ask(&request).map_err(to_error)?;
        self.token = created.authentication_token.clone();
        let policy_id = anonymous(&created).ok_or_else(|| {
            let text = "it does not take clients without encryption and without a user: allow the security policy None with anonymous users";
            LinkError::Refused(text.to_owned())
        })?;
        let request = ActivateSessionRequest {
            request_header: self.wire.header(&self.token),
            user_identity_token: ExtensionObject::from_message(AnonymousIdentityToken {
                policy_id,
            }),
            ..Default::default()
        };
        self.ask::<ActivateSessionResponse>(&request)
            .map(drop)
            .map_err(to_error)
    }

    fn ask<A: Answer>(
        &mut self,
        request: &(impl opcua_types::BinaryEncodable + opcua_types::MessageInfo),
    ) -> Result<A, RequestError> {
        let answer = self.wire.exchange(request).map_err(|broken| {
            self.is_lost = true;
            RequestError::Lost(broken.into_error((&self.request, self.timeout_s), ""))
        })?;
        answer.map_err(|status| self.refusal(status))
    }

    /// Converts a rejection; that of the whole session ends the connection.
    fn refusal(&mut self, status: StatusCode) -> RequestError {
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

    fn other_length(&mut self) -> RequestError {
        self.is_lost = true;
        let text = "its answer is invalid: its length differs from that of the request";
        RequestError::Lost(LinkError::Disconnected(text.to_owned()))
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

/// Token policy for anonymous users on a channel without security.
fn anonymous(created: &CreateSessionResponse) -> Option<UAString> {
    let endpoints = created.server_endpoints.as_deref().unwrap_or_default();
    let open = endpoints
        .iter()
        .filter(|endpoint| endpoint.security_mode == MessageSecurityMode::None);
    let mut policies = open.flat_map(|e| e.user_identity_tokens.iter().flatten());
    let found = policies.find(|policy| policy.token_type == UserTokenType::Anonymous);
    found.map(|policy| policy.policy_id.clone())
}
