//! Values that a server sends on its own, one row for each instant of its sampling.
//!
//! A server answers a publish request when values have changed; several requests are always pending. It sends changed values
//! only, so the last value of every node is kept. A row begins where time stamps advance by more than half of a sampling
//! interval, and ends there, as the values of one instant may come in two messages.

use opcua_types::{
    AttributeId, CreateMonitoredItemsRequest, CreateMonitoredItemsResponse,
    CreateSubscriptionRequest, CreateSubscriptionResponse, DataChangeNotification, DataValue,
    DeleteSubscriptionsRequest, DeleteSubscriptionsResponse, MonitoredItemCreateRequest,
    MonitoringMode, MonitoringParameters, NodeId, PublishRequest, PublishResponse, ReadValueId,
    RequestHeader, StatusChangeNotification, StatusCode, SubStatusCode,
    SubscriptionAcknowledgement, TimestampsToReturn,
};

use super::client::{NODES, OpcUaClient, RequestError};

/// Publish requests that are with the server: as many as small controllers keep.
const PUBLISHES: usize = 5;
/// Publishing intervals without a publish request after which the server ends a subscription, and intervals without a change
/// after which it sends an empty message.
const LIFETIME: u32 = 6000;
const KEEP_ALIVE: u32 = 500;
/// Values of a node that the server keeps between two messages.
const QUEUE: u32 = 32;
/// Ticks of time stamps per second.
const TICKS_PER_S: f64 = 1e7;

/// The last value of every node with its status, in the order of the nodes.
pub(super) type NodeValues = Vec<DataValue>;

/// A subscription of a session.
pub(super) struct Subscription {
    id: u32,
    /// Half of a sampling interval in ticks of time stamps.
    same_instant: i64,
    latest: NodeValues,
    /// Time stamp of the row that later messages may complete.
    begun: Option<i64>,
}

/// A changed value: its time stamp in ticks and its node.
type Change = (i64, usize, DataValue);

impl Subscription {
    fn new(id: u32, nodes: usize, sampling_s: f64) -> Self {
        Self {
            id,
            same_instant: (0.5 * sampling_s * TICKS_PER_S) as i64,
            latest: vec![DataValue::null(); nodes],
            begun: None,
        }
    }

    /// Applies changed values in the order of their time stamps; returns the rows of the instants before the last one.
    fn rows(&mut self, mut changes: Vec<Change>) -> Vec<NodeValues> {
        changes.sort_by_key(|(now, ..)| *now);
        let mut rows = Vec::new();
        for (now, node, value) in changes {
            if self
                .begun
                .is_some_and(|begun| now - begun > self.same_instant)
            {
                rows.extend(self.row());
                self.begun = None;
            }
            self.begun.get_or_insert(now);
            if let Some(latest) = self.latest.get_mut(node) {
                *latest = value;
            }
        }
        rows
    }

    /// The last values, if every node has one.
    fn row(&self) -> Option<NodeValues> {
        let is_known = |value: &DataValue| value.value.is_some() || value.status.is_some();
        self.latest
            .iter()
            .all(is_known)
            .then(|| self.latest.clone())
    }
}

impl OpcUaClient {
    /// Subscribes to the values of nodes, sampled and sent every `every_s` seconds; to all of them or, after a rejection, to none.
    pub fn subscribe(
        &mut self,
        nodes: &[NodeId],
        every_s: f64,
    ) -> Result<Subscription, RequestError> {
        self.request = "for a subscription".to_owned();
        let request = CreateSubscriptionRequest {
            request_header: self.wire.header(&self.token),
            requested_publishing_interval: 1e3 * every_s,
            requested_lifetime_count: LIFETIME,
            requested_max_keep_alive_count: KEEP_ALIVE,
            max_notifications_per_publish: 0,
            publishing_enabled: true,
            priority: 0,
        };
        let id = self
            .ask::<CreateSubscriptionResponse>(&request)?
            .subscription_id;
        match self.monitor(id, nodes, every_s) {
            Ok(sampling_s) => {
                for _ in 0..PUBLISHES {
                    self.publish(None)?;
                }
                Ok(Subscription::new(id, nodes.len(), sampling_s))
            }
            Err(error) => {
                self.unsubscribe(id)?;
                Err(error)
            }
        }
    }

    /// Adds the nodes to the subscription; returns the longest sampling interval (s).
    fn monitor(&mut self, id: u32, nodes: &[NodeId], every_s: f64) -> Result<f64, RequestError> {
        let mut longest_s = every_s;
        for (part, chunk) in nodes.chunks(NODES).enumerate() {
            let item = |(k, node): (usize, &NodeId)| MonitoredItemCreateRequest {
                item_to_monitor: ReadValueId {
                    node_id: node.clone(),
                    attribute_id: AttributeId::Value as u32,
                    ..Default::default()
                },
                monitoring_mode: MonitoringMode::Reporting,
                requested_parameters: MonitoringParameters {
                    client_handle: (part * NODES + k) as u32,
                    sampling_interval: 1e3 * every_s,
                    queue_size: QUEUE,
                    discard_oldest: true,
                    ..Default::default()
                },
            };
            let request = CreateMonitoredItemsRequest {
                request_header: self.wire.header(&self.token),
                subscription_id: id,
                timestamps_to_return: TimestampsToReturn::Source,
                items_to_create: Some(chunk.iter().enumerate().map(item).collect()),
            };
            let answer: CreateMonitoredItemsResponse = self.ask(&request)?;
            let results = answer.results.unwrap_or_default();
            if results.len() != chunk.len() {
                return Err(self.other_length());
            }
            for result in results {
                if !result.status_code.is_good() {
                    return Err(RequestError::Refused(result.status_code));
                }
                longest_s = longest_s.max(1e-3 * result.revised_sampling_interval);
            }
        }
        Ok(longest_s)
    }

    /// Ends a subscription. It does not matter if the server no longer knows it.
    fn unsubscribe(&mut self, id: u32) -> Result<(), RequestError> {
        self.request = "to end a subscription".to_owned();
        let request = DeleteSubscriptionsRequest {
            request_header: self.wire.header(&self.token),
            subscription_ids: Some(vec![id]),
        };
        match self.ask::<DeleteSubscriptionsResponse>(&request) {
            Ok(_) | Err(RequestError::Refused(_)) => Ok(()),
            Err(lost) => Err(lost),
        }
    }

    /// Ends a subscription and discards the values sent for it.
    pub fn end_subscription(&mut self, subscription: &Subscription) -> Result<(), RequestError> {
        self.unsubscribe(subscription.id)?;
        self.told().map(|_| ())
    }

    /// Leaves a publish request with the server, which confirms the message with this number.
    fn publish(
        &mut self,
        confirmed: Option<SubscriptionAcknowledgement>,
    ) -> Result<(), RequestError> {
        self.request = "to publish live values".to_owned();
        let request = PublishRequest {
            // Without a timeout: the server answers when values have changed.
            request_header: RequestHeader {
                timeout_hint: 0,
                ..self.wire.header(&self.token)
            },
            subscription_acknowledgements: confirmed.map(|one| vec![one]),
        };
        let sent = self.wire.leave(&request);
        sent.map_err(|broken| self.broken(broken))
    }

    fn told(&mut self) -> Result<Vec<Result<PublishResponse, StatusCode>>, RequestError> {
        self.request = "for the rest of live values".to_owned();
        let told = self.wire.told();
        told.map_err(|broken| self.broken(broken))
    }

    /// The rows sent since the last call, the oldest first. Does not wait. A rejection ends the subscription, not the session.
    pub fn sent(
        &mut self,
        subscription: &mut Subscription,
    ) -> Result<Vec<NodeValues>, RequestError> {
        let mut changes = Vec::new();
        for answer in self.told()? {
            let answer = match answer {
                Ok(answer) => answer,
                // Fewer requests are with the server from now on.
                Err(status) if status.sub_code() == SubStatusCode::BadTooManyPublishRequests => {
                    continue;
                }
                Err(status) => return Err(self.refusal(status)),
            };
            let message = answer.notification_message;
            let is_ours = answer.subscription_id == subscription.id;
            let notifications = message.notification_data.unwrap_or_default();
            // A message without values only shows that the server is there, and is not confirmed.
            let confirmed = (!notifications.is_empty()).then_some(SubscriptionAcknowledgement {
                subscription_id: answer.subscription_id,
                sequence_number: message.sequence_number,
            });
            self.publish(confirmed)?;
            for notification in notifications.into_iter().filter(|_| is_ours) {
                if let Some(change) = notification.inner_as::<StatusChangeNotification>() {
                    return Err(RequestError::Refused(change.status));
                }
                let Some(data) = notification.into_inner_as::<DataChangeNotification>() else {
                    continue;
                };
                let items = data.monitored_items.unwrap_or_default().into_iter();
                changes.extend(items.map(|item| {
                    let time = item.value.source_timestamp.unwrap_or(message.publish_time);
                    (time.ticks(), item.client_handle as usize, item.value)
                }));
            }
        }
        Ok(subscription.rows(changes))
    }
}

#[cfg(test)]
mod tests {
    use opcua_types::Variant;

    use super::*;

    fn change(ms: i64, node: usize, number: f64) -> Change {
        let value = DataValue {
            value: Some(Variant::Double(number)),
            ..DataValue::null()
        };
        (10_000 * ms, node, value)
    }

    fn numbers(rows: &[NodeValues]) -> Vec<Vec<f64>> {
        let number = |value: &DataValue| match value.value {
            Some(Variant::Double(number)) => number,
            _ => f64::NAN,
        };
        rows.iter()
            .map(|row| row.iter().map(number).collect())
            .collect()
    }

    #[test]
    fn a_row_has_the_last_value_of_every_node_at_its_instant() {
        let mut subscription = Subscription::new(1, 2, 0.01);
        // The second node has no value yet.
        assert!(subscription.rows(vec![change(0, 0, 1.0)]).is_empty());
        assert!(subscription.rows(vec![change(10, 0, 2.0)]).is_empty());
        // Two instants in one message, out of order; the first was begun in the message before, 2 ms earlier.
        let rows = subscription.rows(vec![change(20, 0, 3.0), change(12, 1, -2.0)]);
        assert_eq!(numbers(&rows), [[2.0, -2.0]]);
        assert!(subscription.rows(Vec::new()).is_empty());
        // A node that was not subscribed to.
        let rows = subscription.rows(vec![change(30, 7, 9.0)]);
        assert_eq!(numbers(&rows), [[3.0, -2.0]]);
        let rows = subscription.rows(vec![change(40, 1, 4.0), change(50, 1, 5.0)]);
        assert_eq!(numbers(&rows), [[3.0, -2.0], [3.0, 4.0]]);
    }
}
