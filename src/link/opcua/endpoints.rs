//! Endpoints of a server, and the choice of one of them.

use opcua_crypto::SecurityPolicy;
use opcua_types::{EndpointDescription, MessageSecurityMode, UserTokenPolicy, UserTokenType};
use tautline_session::{OpcUaPolicy, OpcUaSecurity};

use super::address::OpcUaAddress;
use super::protection::policy_of;
use crate::error::LinkError;

/// End of the names of supported transports.
const TRANSPORT: &str = "uatcp-uasc-uabinary";

/// Protection of an endpoint; the policy is that of [`OpcUaSecurity::None`] where there is none.
pub(super) type Protected = (OpcUaSecurity, Option<OpcUaPolicy>);

/// The protection of an endpoint; `None` if it is not supported.
pub(super) fn protection_of(endpoint: &EndpointDescription) -> Option<Protected> {
    let policy = || known_policy(endpoint.security_policy_uri.as_ref());
    match endpoint.security_mode {
        MessageSecurityMode::None => Some((OpcUaSecurity::None, None)),
        MessageSecurityMode::Sign => Some((OpcUaSecurity::Sign, Some(policy()?))),
        MessageSecurityMode::SignAndEncrypt => {
            Some((OpcUaSecurity::SignAndEncrypt, Some(policy()?)))
        }
        MessageSecurityMode::Invalid => None,
    }
}

/// The policy with a name of the standard, if it is supported.
fn known_policy(uri: &str) -> Option<OpcUaPolicy> {
    let mut known = OpcUaPolicy::ALL.into_iter();
    known.find(|policy| policy_of(*policy).to_uri() == uri)
}

/// Type of the token by which a user identifies himself.
pub(super) fn kind_of_user(address: &OpcUaAddress) -> UserTokenType {
    match (&address.user, &address.user_certificate) {
        (_, Some(_)) => UserTokenType::Certificate,
        (Some(_), None) => UserTokenType::UserName,
        (None, None) => UserTokenType::Anonymous,
    }
}

/// The policy for the proof of a user at an endpoint: that of the token, or of the endpoint if the token has none. `None`
/// if it is not supported.
pub(super) fn policy_of_token(
    endpoint: &EndpointDescription,
    token: &UserTokenPolicy,
) -> Option<SecurityPolicy> {
    let own = token.security_policy_uri.as_ref();
    let uri = match own.is_empty() {
        true => endpoint.security_policy_uri.as_ref(),
        false => own,
    };
    known_policy(uri).map(policy_of)
}

/// The token policy of an endpoint for users of a kind.
pub(super) fn token_of(
    endpoint: &EndpointDescription,
    wanted: UserTokenType,
) -> Option<&UserTokenPolicy> {
    let tokens = endpoint.user_identity_tokens.iter().flatten();
    let fitting = tokens.filter(|token| token.token_type == wanted);
    // Passwords and proofs are sent by the best protection that is offered for them.
    fitting.max_by_key(|token| known_policy(token.security_policy_uri.as_ref()))
}

/// The error that a server accepts no users of a kind, with advice.
pub(super) fn no_users(wanted: UserTokenType) -> LinkError {
    LinkError::Refused(match wanted {
        UserTokenType::Certificate => "it takes no users with a certificate: allow them at the server, or give the name of a user instead, like ?user=NAME".to_owned(),
        UserTokenType::Anonymous => "it takes no anonymous clients: add a user to the address, like ?user=NAME".to_owned(),
        _ => "it takes no users with a name and a password: create one at the server".to_owned(),
    })
}

/// The best endpoint that fits an address.
pub(super) fn choose<'e>(
    offered: &'e [EndpointDescription],
    address: &OpcUaAddress,
) -> Result<(&'e EndpointDescription, Protected), LinkError> {
    let known = offered.iter().filter_map(|endpoint| {
        let transport = endpoint.transport_profile_uri.as_ref();
        let is_spoken = transport.is_empty() || transport.ends_with(TRANSPORT);
        is_spoken.then_some((endpoint, protection_of(endpoint)?))
    });
    let known: Vec<_> = known.collect();
    let is_wanted = |(security, policy): Protected| {
        address.security.is_none_or(|wanted| wanted == security)
            && (address.policy.is_none() || address.policy == policy)
    };
    let user = kind_of_user(address);
    let wanted = known.iter().filter(|(_, found)| is_wanted(*found));
    let protected = wanted.clone().max_by_key(|(_, found)| *found);
    let fitting = wanted.filter(|(endpoint, _)| token_of(endpoint, user).is_some());
    if let Some(found) = fitting.max_by_key(|(_, found)| *found) {
        return Ok(*found);
    }
    Err(match protected {
        Some(_) => no_users(user),
        None => LinkError::Refused(format!(
            "it does not offer {}; it offers {}",
            wish(address),
            in_words(&known)
        )),
    })
}

fn wish(address: &OpcUaAddress) -> String {
    match (address.security, address.policy) {
        (Some(security), Some(policy)) => format!("{security} with {policy}"),
        (Some(security), None) => format!("security {security}"),
        (None, Some(policy)) => format!("the policy {policy}"),
        (None, None) => "a security that Tautline has".to_owned(),
    }
}

fn in_words(known: &[(&EndpointDescription, Protected)]) -> String {
    let mut offered: Vec<Protected> = known.iter().map(|(_, found)| *found).collect();
    offered.sort_unstable();
    offered.dedup();
    let words = offered.into_iter().map(|(security, policy)| match policy {
        Some(policy) => format!("{security} with {policy}"),
        None => security.to_string(),
    });
    let words: Vec<String> = words.collect();
    match words.is_empty() {
        true => "nothing that Tautline has".to_owned(),
        false => words.join(", "),
    }
}
