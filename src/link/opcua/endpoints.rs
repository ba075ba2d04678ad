//! What a server offers, and the choice from it.

use opcua_types::{EndpointDescription, MessageSecurityMode, UserTokenPolicy, UserTokenType};
use tautline_session::{OpcUaPolicy, OpcUaSecurity};

use super::address::OpcUaAddress;
use super::protection::policy_of;
use crate::error::LinkError;

/// End of the names of transports that we speak.
const TRANSPORT: &str = "uatcp-uasc-uabinary";

/// Protection of an endpoint; the policy is that of [`OpcUaSecurity::None`] where there is none.
pub(super) type Protected = (OpcUaSecurity, Option<OpcUaPolicy>);

/// The protection of an endpoint; `None` if it is one that we do not have.
pub(super) fn protection_of(endpoint: &EndpointDescription) -> Option<Protected> {
    let uri = endpoint.security_policy_uri.as_ref();
    let policy = || {
        let mut all = OpcUaPolicy::ALL.into_iter();
        all.find(|policy| policy_of(*policy).to_uri() == uri)
    };
    match endpoint.security_mode {
        MessageSecurityMode::None => Some((OpcUaSecurity::None, None)),
        MessageSecurityMode::Sign => Some((OpcUaSecurity::Sign, Some(policy()?))),
        MessageSecurityMode::SignAndEncrypt => {
            Some((OpcUaSecurity::SignAndEncrypt, Some(policy()?)))
        }
        MessageSecurityMode::Invalid => None,
    }
}

/// The way in which an endpoint takes a user: anonymous, or with a name.
pub(super) fn token_of<'e>(
    endpoint: &'e EndpointDescription,
    user: Option<&str>,
) -> Option<&'e UserTokenPolicy> {
    let wanted = match user {
        Some(_) => UserTokenType::UserName,
        None => UserTokenType::Anonymous,
    };
    let tokens = endpoint.user_identity_tokens.iter().flatten();
    let fitting = tokens.filter(|token| token.token_type == wanted);
    // A password is sent by the best protection that is offered for it.
    fitting.max_by_key(|token| {
        let uri = token.security_policy_uri.as_ref();
        OpcUaPolicy::ALL
            .into_iter()
            .rfind(|policy| policy_of(*policy).to_uri() == uri)
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
    let user = address.user.as_deref();
    let wanted = known.iter().filter(|(_, found)| is_wanted(*found));
    let protected = wanted.clone().max_by_key(|(_, found)| *found);
    let fitting = wanted.filter(|(endpoint, _)| token_of(endpoint, user).is_some());
    if let Some(found) = fitting.max_by_key(|(_, found)| *found) {
        return Ok(*found);
    }
    Err(LinkError::Refused(match protected {
        None => format!(
            "it does not offer {}; it offers {}",
            wish(address),
            in_words(&known)
        ),
        Some(_) if user.is_some() => {
            "it takes no users with a name and a password: create one at the server".to_owned()
        }
        Some(_) => {
            "it takes no anonymous clients: add a user to the address, like ?user=NAME".to_owned()
        }
    }))
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
