//! Opening a session: endpoints and certificate of the server, channel, user.

use std::time::SystemTime;

use opcua_crypto::SecurityPolicy;
use opcua_types::{
    ActivateSessionRequest, ActivateSessionResponse, AnonymousIdentityToken,
    ApplicationDescription, ApplicationType, ByteString, CreateSessionRequest,
    CreateSessionResponse, EndpointDescription, ExtensionObject, GetEndpointsRequest,
    GetEndpointsResponse, MessageSecurityMode, NodeId, SignatureData, StatusCode, SubStatusCode,
    UAString, UserNameIdentityToken, UserTokenPolicy, UserTokenType, X509IdentityToken,
};
use tautline_session::OpcUaSecurity;

use super::OpcUaServer;
use super::address::OpcUaAddress;
use super::certificate::ServerCertificate;
use super::client::{OpcUaClient, RequestError};
use super::credentials::Credentials;
use super::endpoints::{choose, kind_of_user, no_users, policy_of_token, token_of};
use super::protection::{Protection, policy_of};
use super::user::UserIdentity;
use super::wire::{Wire, explain};
use crate::error::{LinkError, UntrustedServer};
use crate::timed_socket::{SocketError, addresses_of, timeout_of};

/// Time for which the server keeps an idle session (ms).
const SESSION_MS: f64 = 300_000.0;
const NAME: &str = "Tautline";
/// Name of the application where no certificate has one.
const APPLICATION: &str = "urn:tautline";

/// Advice for a server that ends an encrypted connection at once, usually without a reason.
const OURS: &str = "if it does not trust our certificate yet, add the one that `tautline certificate -o FILE.der` writes to its trusted clients";

/// Connects to a server and opens a session.
pub(super) fn open(server: &OpcUaServer) -> Result<OpcUaClient, LinkError> {
    // Files that cannot be used are reported before anything is sent.
    let files = server.address.user_certificate.as_ref();
    let user = files.map(|files| UserIdentity::read(files, SystemTime::now()));
    let user = user.transpose()?;
    let begin = |wire| begin(server, user.as_ref(), wire);
    if server.address.security == Some(OpcUaSecurity::None) {
        return begin(connect(server, None)?);
    }
    let mut plain = connect(server, None)?;
    let offered = endpoints(server, &mut plain)?;
    let (endpoint, found) = choose(&offered, &server.address)?;
    let (security, Some(policy)) = found else {
        // A man in the middle could pretend that the server has no endpoints.
        let known = server.credentials.keys.trusted(&server.address.origin())?;
        return match known {
            None => begin(plain),
            Some(_) => Err(LinkError::Refused(
                "it offers no security any more, although its certificate is trusted: if that is intended, add ?security=None to the address".to_owned(),
            )),
        };
    };
    let application = &endpoint.server.application_uri;
    let certificate = trusted(server, &endpoint.server_certificate, application)?;
    plain.close();
    let identity = server.credentials.keys.identity()?;
    let protection = Protection::new(security, policy, identity, certificate);
    begin(connect(server, Some(protection))?)
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

/// Endpoints that the server offers without a session.
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
fn trusted(
    server: &OpcUaServer,
    sent: &ByteString,
    application: &UAString,
) -> Result<ServerCertificate, LinkError> {
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
    let names = (server.address.host.as_str(), application.as_ref());
    certificate.check(names, SystemTime::now())?;
    Ok(certificate)
}

/// Creates and activates a session.
fn begin(
    server: &OpcUaServer,
    certified: Option<&UserIdentity>,
    wire: Wire,
) -> Result<OpcUaClient, LinkError> {
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
    let user = kind_of_user(&server.address);
    let token = token_of(&endpoint, user).ok_or_else(|| no_users(user))?;
    let at = (&endpoint, token);
    let (user_identity_token, user_token_signature) = match certified {
        Some(certified) => certified_user(server, &client, at, &created, certified)?,
        None => (
            user_token(server, &client, at, &created)?,
            SignatureData::null(),
        ),
    };
    let client_signature = match client.wire.protection() {
        Some(protection) => protection.sign(&created.server_nonce)?,
        None => SignatureData::null(),
    };
    let request = ActivateSessionRequest {
        request_header: client.wire.header(&client.token),
        client_signature,
        user_identity_token,
        user_token_signature,
        ..Default::default()
    };
    let activated = client.ask::<ActivateSessionResponse>(&request);
    activated.map_err(|error| match error {
        RequestError::Refused(status) => {
            refused_user(&server.address, status).unwrap_or_else(|| to_error(error))
        }
        error @ RequestError::Lost(_) => to_error(error),
    })?;
    Ok(client)
}

/// The refusal of a user; `None` if the status is about something else.
fn refused_user(address: &OpcUaAddress, status: StatusCode) -> Option<LinkError> {
    use SubStatusCode as S;
    let code = status.sub_code();
    let is_unknown = matches!(
        code,
        S::BadUserAccessDenied | S::BadIdentityTokenRejected | S::BadIdentityTokenInvalid
    );
    let is_about_certificate = matches!(
        code,
        S::BadUserSignatureInvalid
            | S::BadCertificateInvalid
            | S::BadCertificateTimeInvalid
            | S::BadCertificateUntrusted
    );
    let who = match (&address.user, &address.user_certificate) {
        (Some(user), _) if is_unknown => format!("the user {user:?} with this password"),
        (_, Some(files)) if is_unknown || is_about_certificate => {
            format!("the user of the certificate {:?}", files.certificate)
        }
        _ => return None,
    };
    Some(LinkError::UnknownUser(format!(
        "it does not know {who}, or allows nothing to it (OPC UA {code})"
    )))
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

/// The endpoint of the session as the server describes it on the channel. On a protected channel the server must have signed
/// our random number, and its endpoints must be those offered before, so that nobody in between removed better ones.
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
        let user = kind_of_user(&server.address);
        let fitting = open.find(|endpoint| token_of(endpoint, user).is_some());
        return fitting.cloned().ok_or_else(|| match user {
            UserTokenType::Anonymous => LinkError::Refused("it does not take clients without encryption and without a user: allow the security policy None with anonymous users, or add a user to the address".to_owned()),
            user => no_users(user),
        });
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

/// The token of a user without a certificate.
fn user_token(
    server: &OpcUaServer,
    client: &OpcUaClient,
    (endpoint, token): (&EndpointDescription, &UserTokenPolicy),
    created: &CreateSessionResponse,
) -> Result<ExtensionObject, LinkError> {
    match &server.address.user {
        Some(name) => named_user(server, client, (endpoint, token), created, name),
        None => Ok(ExtensionObject::from_message(AnonymousIdentityToken {
            policy_id: token.policy_id.clone(),
        })),
    }
}

/// The certificate of the server on its channel, which without protection is compared only now.
fn certificate_of_server(
    server: &OpcUaServer,
    client: &OpcUaClient,
    created: &CreateSessionResponse,
    endpoint: &EndpointDescription,
) -> Result<ServerCertificate, LinkError> {
    match client.wire.protection() {
        Some(protection) => Ok(protection.server().clone()),
        None => {
            let application = &endpoint.server.application_uri;
            trusted(server, &created.server_certificate, application)
        }
    }
}

/// The token of a user with a certificate, who proves by a signature that the private key is his.
fn certified_user(
    server: &OpcUaServer,
    client: &OpcUaClient,
    (endpoint, token): (&EndpointDescription, &UserTokenPolicy),
    created: &CreateSessionResponse,
    user: &UserIdentity,
) -> Result<(ExtensionObject, SignatureData), LinkError> {
    let policy = policy_of_token(endpoint, token).ok_or_else(|| {
        let text = "it takes users with a certificate without a signature, or under a policy that Tautline does not have: use ?security=SignAndEncrypt";
        LinkError::Refused(text.to_owned())
    })?;
    let certificate = certificate_of_server(server, client, created, endpoint)?;
    let signature = user.sign(policy, (&certificate, &created.server_nonce))?;
    let token = ExtensionObject::from_message(X509IdentityToken {
        policy_id: token.policy_id.clone(),
        certificate_data: user.certificate(),
    });
    Ok((token, signature))
}

/// The token of a user with a name, whose password is encrypted with the certificate of the server.
fn named_user(
    server: &OpcUaServer,
    client: &OpcUaClient,
    (endpoint, token): (&EndpointDescription, &UserTokenPolicy),
    created: &CreateSessionResponse,
    name: &str,
) -> Result<ExtensionObject, LinkError> {
    let Credentials { keys, password } = &server.credentials;
    let password = match (password, server.address.account()) {
        (None, Some(account)) => keys.password(&account)?,
        (given, _) => given.clone(),
    };
    let needed = || LinkError::Refused(format!("the user {name:?} needs a password"));
    let password = password.ok_or_else(needed)?;
    let channel = client.wire.protection().map(Protection::policy);
    let is_encrypted = endpoint.security_mode == MessageSecurityMode::SignAndEncrypt;
    let is_plain = token.security_policy_uri.as_ref() == SecurityPolicy::None.to_uri();
    if policy_of_token(endpoint, token).is_none() && !(is_encrypted && is_plain) {
        let text = "it would take the password without encryption that Tautline has: use ?security=SignAndEncrypt";
        return Err(LinkError::Refused(text.to_owned()));
    }
    let certificate = certificate_of_server(server, client, created, endpoint)?;
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
