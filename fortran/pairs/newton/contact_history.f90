!> History of contact on the present shape: the state that an increment starts from, and the one
!> that it leaves.
module lopin_contact_history
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_friction_touch, only : touching
   use lopin_enforcement_parameters, only : remember_elastic
   use lopin_nonlinear_points, only : nonlinear_points_type
   use lopin_nonlinear_samples, only : offset_of
   use lopin_master_surfaces, only : move_masters, measure_walls
   use lopin_slave_areas, only : follow_areas
   use lopin_facet_hysteresis, only : start_facet_hysteresis, kept_beyond
   use lopin_state, only : contact_state_type
   use lopin_nonlinear_contact, only : nonlinear_contact_type, set_slopes, place_of
   use lopin_contact_detection, only : find_closest_features, detect_contact, take_anchor, &
      & assign_roles
   use lopin_initial_contact, only : measure_initial_contact
   use lopin_nonlinear_faces, only : find_inner_feet
   use lopin_touch_onset, only : start_approach
   use lopin_slip_increment, only : anchor_slip, slip_from_anchor, path_of, dissipated, &
      & mean_work_of, speed_of, turn
   implicit none
   private
   public :: start_increment, augment, leave_history

contains

   !> Search from the accepted state; anchors of friction; tractions turned with the normals. Ties
   !> are those of the state in which contact was met first.
   subroutine start_increment(self, model, accepted, u, dt, error)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(contact_state_type), intent(in) :: accepted
      real(wp), intent(in) :: u(:)             !! (ndof) accepted displacements
      real(wp), intent(in) :: dt               !! [time]
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      self%dt = dt
      if (.not. allocated(self%met_at)) then
         if (allocated(accepted%search%met_at)) then
            call measure_initial_contact(self, model, accepted%search%met_at, error)
         else
            call measure_initial_contact(self, model, u, error)
         end if
         if (allocated(error)) return
      end if
      call move_masters(self%masters, model, self%dofs, self%nonlinear_points_type, u, .true., &
         & self%cost, error)
      if (allocated(error)) return
      call measure_walls(self%masters, self%nonlinear_points_type, &
         & [(accepted%closed(place_of(self, i, accepted%closed)), i=1, self%n)])
      call start_search(self, accepted)
      call find_closest_features(self, .true., .false., error)
      if (allocated(error)) return
      do i = 1, self%n
         call detect_contact(self, model, i, .true.)
         if (.not. self%enforcement(i)%tied) then
            call take_anchor(self, model, i)
            self%anchor(i)%offset = offset_of(self%masters, self%nonlinear_points_type, i)
         end if
         if (self%opposite(i)%facet > 0) self%masters%part(i) = self%opposite(i)%foot%segment
         call start_point(self, model, i, accepted)
      end do
      call set_slopes(self, accepted%stiffer)
      call follow_areas(self, model)
      if (size(self%face) > 0) then
         self%face_met = spread(.false., 1, size(self%face))
         call find_inner_feet(self%opposite, self%masters, self%nonlinear_points_type, model, &
            & self%masters%start_x, self%face_met)
      end if
      self%start_u = u
      call start_approach(self)
      call assign_roles(self, model, accepted)
   end subroutine start_increment

   !> The law of a point where an increment begins: from the accepted tractions, turned.
   subroutine start_point(self, model, i, accepted)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      type(contact_state_type), intent(in) :: accepted

      associate (g => self%enforcement(i), k => place_of(self, i, accepted%closed))
         g%ct = self%ct(i)
         g%c = self%c(i)
         g%grazing = touching*g%c*self%size(i)
         g%committed = accepted%traction(:, k)
         g%creep = accepted%creep(:, k)
         if (self%opposite(i)%facet > 0) then
            call turn(accepted%normal(:, k), self%opposite(i)%normal, g%committed)
            call turn(accepted%normal(:, k), self%opposite(i)%normal, g%creep)
         end if
         self%start_normal(:, i) = self%opposite(i)%normal
         g%frozen = g%committed
         g%approach = 0.0_wp
         g%bilateral = accepted%closed(k) &
            & .and. model%interaction(model%pair(self%pair(i))%interaction)%no_separation
         self%bilateral(i) = g%bilateral .or. g%tied
         g%yield = self%yield(i)
         call remember_elastic(g, self%friction(self%pair(i)), self%opposite(i)%normal, &
            & self%eased(i))
      end associate
   end subroutine start_point

   !> What the search goes on from.
   subroutine start_search(self, accepted)
      type(nonlinear_contact_type), intent(inout) :: self
      type(contact_state_type), intent(in) :: accepted
      integer :: pair, n

      call start_facet_hysteresis(self%masters%owner, accepted%facet)
      self%masters%part = accepted%search%segment
      n = 0
      do pair = 1, size(self%mortar)
         if (.not. self%mortar(pair)%is_on) cycle
         associate (mortar => self%mortar(pair))
            if (.not. mortar%tied) mortar%cover%state = accepted%search%cover(n + 1:n &
               & + size(mortar%cover%state))
            n = n + size(mortar%cover%state)
         end associate
      end do
   end subroutine start_search

   !> Augmented Lagrangian: take the present tractions for the next solve.
   subroutine augment(self, nil, change, beyond)
      type(nonlinear_contact_type), intent(inout) :: self
      real(wp), intent(in) :: nil(:)           !! (n) gaps that are rounding of places [length]
      real(wp), intent(out) :: change          !! relative, of the tractions
      real(wp), intent(out) :: beyond          !! the same, beyond what rounding makes
      real(wp) :: most, moved, step, above, of(3)
      integer :: i

      most = 0.0_wp
      moved = 0.0_wp
      above = 0.0_wp
      do i = 1, self%n
         if (.not. self%enforcement(i)%method%updates()) cycle
         most = max(most, norm2(self%traction(:, i)))
         call self%enforcement(i)%method%update(self%traction(:, i), self%enforcement(i)%frozen, of)
         step = norm2(of)
         moved = max(moved, step)
         above = max(above, step - self%enforcement(i)%slope*nil(i))
      end do
      change = 0.0_wp
      beyond = 0.0_wp
      if (.not. most > 0.0_wp) return
      change = moved/most
      beyond = above/most
   end subroutine augment

   !> What the last evaluation leaves, as a trial.
   subroutine leave_history(self, accepted, trial)
      type(nonlinear_contact_type), intent(in) :: self
      type(contact_state_type), intent(in) :: accepted
      type(contact_state_type), intent(inout) :: trial
      integer :: i, k, pair

      trial%search%met_at = self%met_at
      trial%search%segment = self%masters%part
      trial%search%cover = [integer ::]
      do pair = 1, size(self%mortar)
         if (self%mortar(pair)%is_on) trial%search%cover = [trial%search%cover, &
            & self%mortar(pair)%cover%state]
      end do
      ! Tractions go on by the area that the next increment begins with.
      trial%multiplier = trial%multiplier/self%growth(self%point_of_row)%ratio
      do i = 1, self%n
         trial%facet(i) = kept_beyond(self%masters%owner, i, self%opposite(i)%past &
            & .and. self%status(i) /= 0)
         associate (t => self%trial(i))
            if (self%facet(i) == 0 .or. t%status == 0) then
               trial%speed(i) = 0.0_wp
               ! A pair that is taken away has no memory when it comes back.
               if (.not. self%pair_active(self%pair(i))) trial%closed(i) = .false.
               trial%traction(:, i) = 0.0_wp
               trial%creep(:, i) = 0.0_wp
               if (self%facet(i) > 0) trial%normal(:, i) = t%normal
               cycle
            end if
            trial%closed(i) = .true.
            trial%traction(:, i) = t%traction/self%growth(i)%ratio
            trial%normal(:, i) = t%normal
            k = place_of(self, i, accepted%closed)
            trial%slip(:, i) = accepted%slip(:, k) + t%slip
            trial%creep(:, i) = anchor_slip(self%friction(self%pair(i)), slip_from_anchor(self, i))
            trial%slip_path(i) = accepted%slip_path(k) + path_of(self, i)
            trial%speed(i) = speed_of(self, i)
            trial%friction_work(i) = accepted%friction_work(i) + dissipated(self, i)*self%weight(i)
            trial%mean_work(i) = accepted%mean_work(i) + mean_work_of(self, i)*self%weight(i)
         end associate
      end do
   end subroutine leave_history
end module lopin_contact_history
