//! Opening a session: what the server offers, its certificate, the channel, the user.

use std::time::SystemTime;

use opcua_crypto::SecurityPolicy;
use opcua_types::{
    ActivateSessionRequest, ActivateSessionResponse, AnonymousIdentityToken,
    ApplicationDescription, ApplicationType, ByteString, CreateSessionRequest,
    CreateSessionResponse, EndpointDescription, ExtensionObject, GetEndpointsRequest,
    GetEndpointsResponse, MessageSecurityMode, NodeId, SignatureData, StatusCode, SubStatusCode,
    UAString, UserNameIdentityToken, UserTokenPolicy,
};
use tautline_session::{OpcUaPolicy, OpcUaSecurity};

use super::OpcUaServer;
use super::certificate::ServerCertificate;
use super::client::{OpcUaClient, RequestError};
use super::endpoints::{choose, token_of};
use super::protection::{Protection, policy_of};
use super::wire::{Wire, explain};
use crate::error::{LinkError, UntrustedServer};
use crate::timed_socket::{SocketError, addresses_of, timeout_of};

/// Time for which the server keeps an idle session (ms).
const SESSION_MS: f64 = 300_000.0;
const NAME: &str = "Tautline";
/// Name of the application where no certificate has one.
const APPLICATION: &str = "urn:tautline";

/// What to do about a server that ends an encrypted connection at its beginning, mostly without a reason.
const OURS: &str = "if it does not trust our certificate yet, add the one that `tautline certificate -o FILE.der` writes to its trusted clients";

/// Connects to a server and opens a session.
pub(super) fn open(server: &OpcUaServer) -> Result<OpcUaClient, LinkError> {
    if server.address.security == Some(OpcUaSecurity::None) {
        return begin(server, connect(server, None)?);
    }
    let mut plain = connect(server, None)?;
    let offered = endpoints(server, &mut plain)?;
    let (endpoint, found) = choose(&offered, &server.address)?;
    let (security, Some(policy)) = found else {
        // Whoever stands between could say that the server offers nothing.
        let known = server.credentials.keys.trusted(&server.address.origin())?;
        return match known {
            None => begin(server, plain),
            Some(_) => Err(LinkError::Refused(
                "it offers no security any more, although its certificate is trusted: if that is intended, add ?security=None to the address".to_owned(),
            )),
        };
    };
    let certificate = trusted(server, &endpoint.server_certificate)?;
    plain.close();
    let identity = server.credentials.keys.identity()?;
    let protection = Protection::new(security, policy, identity, certificate);
    begin(server, connect(server, Some(protection))?)
}

/// Connects to the first address of the host that answers.
fn connect(server: &OpcUaServer, protection: Option<Protection>) -> Result<Wire, LinkError> {
    let (address, timeout_s) = (&server.address, server.options.timeout_s);
    let timeout = timeout_of(timeout_s)?;
    let url = address.url();
    let mut protection = protection;
    let is_protected = protection.is_some();
    let mut last = None;
    for place in addresses_of(&address.host, address.port)? {
        match Wire::connect(place, &url, timeout, &mut protection) {
            Ok(wire) => return Ok(wire),
            Err(SocketError::Invalid(what)) => {
                last = Some(LinkError::Disconnected(format!(
                    "the server at {place} does not speak OPC UA ({what})"
                )));
            }
            Err(SocketError::Io(error)) => {
                let text = format!("{place} cannot be reached ({error})");
                last = Some(LinkError::Disconnected(text));
            }
            Err(SocketError::Ended(why)) if is_protected => {
                last = Some(LinkError::Refused(format!("{why}; {OURS}")));
            }
            Err(SocketError::Closed) if is_protected => {
                let text = format!("it closed the connection; {OURS}");
                last = Some(LinkError::Refused(text));
            }
            Err(broken) => {
                let request = ("for a connection", timeout_s);
                last = Some(broken.into_error(request, ""));
            }
        }
    }
    let none = || LinkError::Disconnected(format!("{url} has no address"));
    Err(last.unwrap_or_else(none))
}

/// What the server offers to everybody.
fn endpoints(server: &OpcUaServer, wire: &mut Wire) -> Result<Vec<EndpointDescription>, LinkError> {
    let request = GetEndpointsRequest {
        request_header: wire.header(&NodeId::null()),
        endpoint_url: UAString::from(server.address.url()),
        ..Default::default()
    };
    let asked = ("what it offers", server.options.timeout_s);
    let answer = wire.exchange::<GetEndpointsResponse>(&request);
    let answer = answer.map_err(|broken| broken.into_error(asked, ""))?;
    let answer = answer.map_err(|status| LinkError::Refused(explain(status)))?;
    Ok(answer.endpoints.unwrap_or_default())
}

/// The certificate that the server sent, if it is trusted and can be used.
fn trusted(server: &OpcUaServer, sent: &ByteString) -> Result<ServerCertificate, LinkError> {
    let certificate = ServerCertificate::read(sent.as_ref())?;
    let (origin, fingerprint) = (server.address.origin(), certificate.fingerprint());
    let known = server.credentials.keys.trusted(&origin)?;
    if known != Some(fingerprint) {
        return Err(LinkError::Untrusted(Box::new(UntrustedServer {
            server: origin,
            fingerprint,
            known,
        })));
    }
    certificate.check(&server.address.host, SystemTime::now())?;
    Ok(certificate)
}

/// Creates and activates a session.
fn begin(server: &OpcUaServer, wire: Wire) -> Result<OpcUaClient, LinkError> {
    let mut client = OpcUaClient::new(wire, server.options.timeout_s);
    let protection = client.wire.protection();
    let (uri, certificate, nonce) = match protection {
        Some(protection) => (
            protection.identity().uri().to_owned(),
            ByteString::from(protection.identity().certificate()),
            protection.policy().random_nonce(),
        ),
        None => (
            APPLICATION.to_owned(),
            ByteString::null(),
            ByteString::null(),
        ),
    };
    let url = server.address.url();
    let request = CreateSessionRequest {
        request_header: client.wire.header(&NodeId::null()),
        client_description: ApplicationDescription {
            application_uri: UAString::from(uri),
            product_uri: UAString::from(APPLICATION),
            application_name: NAME.into(),
            application_type: ApplicationType::Client,
            ..Default::default()
        },
        endpoint_url: UAString::from(url),
        session_name: UAString::from(NAME),
        client_nonce: nonce.clone(),
        client_certificate: certificate,
        requested_session_timeout: SESSION_MS,
        ..Default::default()
    };
    let created: CreateSessionResponse = client.ask(&request).map_err(to_error)?;
    client.token = created.authentication_token.clone();
    let endpoint = used_endpoint(server, &client, &created, &nonce)?;
    let user = server.address.user.as_deref();
    let token = token_of(&endpoint, user).ok_or_else(|| refused_user(user))?;
    let user_identity_token = match user {
        None => ExtensionObject::from_message(AnonymousIdentityToken {
            policy_id: token.policy_id.clone(),
        }),
        Some(name) => named_user(server, &client, (&endpoint, token), &created, name)?,
    };
    let client_signature = match client.wire.protection() {
        Some(protection) => protection.sign(&created.server_nonce)?,
        None => SignatureData::null(),
    };
    let request = ActivateSessionRequest {
        request_header: client.wire.header(&client.token),
        client_signature,
        user_identity_token,
        ..Default::default()
    };
    let activated = client.ask::<ActivateSessionResponse>(&request);
    activated.map_err(|error| match (error, user) {
        (RequestError::Refused(status), Some(user)) if is_about_user(status) => {
            let text = format!(
                "it does not know the user {user:?} with this password, or allows nothing to it (OPC UA {})",
                status.sub_code()
            );
            LinkError::Refused(text)
        }
        (error, _) => to_error(error),
    })?;
    Ok(client)
}

fn is_about_user(status: StatusCode) -> bool {
    use SubStatusCode as S;
    matches!(
        status.sub_code(),
        S::BadUserAccessDenied | S::BadIdentityTokenRejected | S::BadIdentityTokenInvalid
    )
}

fn to_error(error: RequestError) -> LinkError {
    use SubStatusCode as S;
    match error {
        RequestError::Lost(error) => error,
        RequestError::Refused(status) => LinkError::Refused(match status.sub_code() {
            S::BadCertificateUntrusted | S::BadSecurityChecksFailed => {
                format!("{}; {OURS}", explain(status))
            }
            _ => explain(status),
        }),
    }
}

fn refused_user(user: Option<&str>) -> LinkError {
    LinkError::Refused(match user {
        Some(_) => "it takes no users with a name and a password: create one at the server".to_owned(),
        None => "it does not take clients without encryption and without a user: allow the security policy None with anonymous users, or add a user to the address".to_owned(),
    })
}

/// The endpoint of the session as the server describes it on the channel. On a protected channel the server must have signed
/// our random number, and what it offers must be what everybody was told: nobody in between left the better away.
fn used_endpoint(
    server: &OpcUaServer,
    client: &OpcUaClient,
    created: &CreateSessionResponse,
    nonce: &ByteString,
) -> Result<EndpointDescription, LinkError> {
    let offered = created.server_endpoints.as_deref().unwrap_or_default();
    let invalid = |what: &str| LinkError::Refused(format!("its session {what}"));
    let Some(protection) = client.wire.protection() else {
        let mut open = offered
            .iter()
            .filter(|endpoint| endpoint.security_mode == MessageSecurityMode::None);
        let user = server.address.user.as_deref();
        let fitting = open.find(|endpoint| token_of(endpoint, user).is_some());
        return fitting.cloned().ok_or_else(|| refused_user(user));
    };
    let certificate = protection.server();
    if !certificate.is(created.server_certificate.as_ref()) {
        return Err(invalid("has another certificate than its channel"));
    }
    if !protection.is_signed_by_server(&created.server_signature, nonce) {
        return Err(invalid("is not signed by the server"));
    }
    let (endpoint, found) = choose(offered, &server.address)?;
    let is_used = found
        .1
        .is_some_and(|policy| policy_of(policy) == protection.policy())
        && endpoint.security_mode == protection.mode();
    match is_used {
        true => Ok(endpoint.clone()),
        false => Err(invalid(
            "offers another security than everybody is told: somebody may stand between",
        )),
    }
}

/// The token of a user with a name, whose password is encrypted with the certificate of the server.
fn named_user(
    server: &OpcUaServer,
    client: &OpcUaClient,
    (endpoint, token): (&EndpointDescription, &UserTokenPolicy),
    created: &CreateSessionResponse,
    name: &str,
) -> Result<ExtensionObject, LinkError> {
    let password = server
        .credentials
        .password
        .as_ref()
        .ok_or_else(|| LinkError::Refused(format!("the user {name:?} needs a password")))?;
    let protection = client.wire.protection();
    let channel = protection.map(Protection::policy);
    let own = token.security_policy_uri.as_ref();
    let policy = match own.is_empty() {
        true => channel,
        false => known_policy(own),
    };
    let is_encrypted = endpoint.security_mode == MessageSecurityMode::SignAndEncrypt;
    let is_plain = own == SecurityPolicy::None.to_uri();
    if policy.is_none() && !(is_encrypted && is_plain) {
        let text = "it would take the password without encryption that Tautline has: use ?security=SignAndEncrypt";
        return Err(LinkError::Refused(text.to_owned()));
    }
    let certificate = match protection {
        Some(protection) => protection.server().clone(),
        None => trusted(server, &created.server_certificate)?,
    };
    let secret = opcua_crypto::legacy_encrypt_secret(
        channel.unwrap_or(SecurityPolicy::None),
        endpoint.security_mode,
        token,
        created.server_nonce.as_ref(),
        &Some(certificate.x509().clone()),
        password.as_bytes(),
    );
    let secret = secret.map_err(|error| {
        LinkError::Refused(format!(
            "the password cannot be encrypted ({})",
            error.status()
        ))
    })?;
    Ok(ExtensionObject::from_message(UserNameIdentityToken {
        policy_id: secret.policy,
        user_name: UAString::from(name),
        password: secret.secret,
        encryption_algorithm: secret.encryption_algorithm,
    }))
}

/// The policy with a name of the standard, if it is one of ours.
fn known_policy(uri: &str) -> Option<SecurityPolicy> {
    let mut known = OpcUaPolicy::ALL.into_iter().map(policy_of);
    known.find(|policy| policy.to_uri() == uri)
}
