!> Contact on the present shape at trial displacements: gaps, laws, forces, rows and slopes.
module lopin_contact_evaluation
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_local_matrix, only : local_matrix_type
   use lopin_nonlinear_points, only : nonlinear_points_type
   use lopin_master_surfaces, only : move_masters
   use lopin_closest_feature, only : anchor_of
   use lopin_facet_hysteresis, only : record_facet
   use lopin_nonlinear_faces, only : find_inner_feet
   use lopin_nonlinear_samples, only : find_sample_feet
   use lopin_friction, only : has_friction
   use lopin_contact_row, only : take_corner, point_state_type, point_law_type
   use lopin_contact_inputs, only : point_view_type
   use lopin_contact_element, only : evaluate_point
   use lopin_tool_point, only : evaluate_tool_point
   use lopin_mortar_element, only : evaluate_mortar_point
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   use lopin_contact_detection, only : find_closest_features, detect_contact, is_excluded
   use lopin_slip_increment, only : condition_at, speed_of
   use lopin_slave_areas, only : find_growth, find_growth_slopes
   use lopin_touch_onset, only : may_touch, note_approach
   use lopin_clear_rows, only : shift_of, is_clear, is_alone, reads_tool
   use lopin_touch_path, only : find_gap_path
   implicit none
   private
   public :: evaluate_contact

contains

   !> Project at x = X + u, apply the laws: force, row and, if asked, the local matrices.
   subroutine evaluate_contact(self, model, u, multiplier, with_tangent, error)
      type(nonlinear_contact_type), intent(inout), target :: self
      type(model_type), intent(in), target :: model
      real(wp), intent(in) :: u(:)             !! (ndof)
      real(wp), intent(in) :: multiplier(:)    !! (nmultiplier) tractions, global axes [stress]
      logical, intent(in) :: with_tangent
      type(error_type), allocatable, intent(out) :: error
      type(point_view_type) :: point
      type(point_law_type) :: law
      logical :: again
      integer :: i, d, pass

      d = model%mesh%ndim
      self%force = 0.0_wp
      self%row = 0.0_wp
      self%nlocal = 0
      self%soft_error = 0.0_wp
      call detect_all(self, model, u, with_tangent, error)
      if (allocated(error)) return
      call view_points(point, self, model)
      law%with_tangent = with_tangent
      call mark_corners(self, model, multiplier)
      do i = 1, self%n
         call begin_point(self, model, i, multiplier, law)
         if (is_left_open(self, i, law)) cycle
         if (with_tangent) call find_growth_slopes(self, model, i)
         law%enforcement => self%enforcement(i)
         law%friction => self%friction(self%pair(i))
         point%i = i
         point%opposite => self%opposite(i)
         point%anchor => self%anchor(i)
         self%nlocal = self%nlocal + 1
         associate (local => self%local(self%nlocal), mortar => self%mortar(self%pair(i)))
            do pass = 1, 2
               law%at = condition_at(self, i)
               if (mortar%is_on .or. self%mortar_anchor(i)%tie%set) then
                  call evaluate_mortar_point(self%trial(i), local, mortar, self%dofs, &
                     & self%masters%x, self%patch(i), self%mortar_anchor(i), law)
                  self%weight(i) = self%trial(i)%weight
               else if (is_alone(self, i, law)) then
                  call evaluate_tool_point(self%trial(i), local, point, law, &
                     & reads_tool(self, i, law))
               else
                  call evaluate_point(self%trial(i), local, point, law)
               end if
               if (pass == 2 .or. .not. may_touch(self, i)) exit
               ! The motion before the point touched is no slip; with it, once more.
               call note_approach(self, i, law%shift, again)
               if (.not. again) exit
            end do
         end associate
         call collect(self, model, i, d, law)
      end do
      if (with_tangent) call record_facets(self)
      call estimate_softness(self)
      ! Touching counts as closed where Newton starts, and no longer; so does the limit as sticking.
      self%enforcement%grazing = 0.0_wp
      self%enforcement%clings = .false.
   end subroutine evaluate_contact

   !> All points, of which one is looked at.
   subroutine view_points(point, self, model)
      type(point_view_type), intent(out) :: point
      type(nonlinear_contact_type), intent(in), target :: self
      type(model_type), intent(in), target :: model

      point%model => model
      point%dofs => self%dofs
      point%basis => self%basis
      point%masters => self%masters
      point%points => self%nonlinear_points_type
   end subroutine view_points

   !> Nodes that two walls of a tool press, with unknown tractions: what the other wall keeps a
   !> point from is no slip on its own.
   subroutine mark_corners(self, model, multiplier)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: multiplier(:)    !! (nmultiplier) [stress]
      logical :: both(2)
      integer :: i, k

      do i = 2, self%n
         if (self%entry(i) /= 2) cycle
         if (.not. has_friction(self%friction(self%pair(i)))) cycle
         do k = 1, 2
            associate (space => self%enforcement(i + k - 2)%space)
               space%limited = space%supported
               space%taken = space%support
               space%follows = .false.
            end associate
            call find_pressing(self, model, i + k - 2, multiplier, both(k))
         end do
         if (.not. all(both)) cycle
         do k = i - 1, i
            call take_corner(self%enforcement(k)%space, self%opposite(k)%normal, &
               & self%opposite(2*i - 1 - k)%normal)
         end do
         self%enforcement(i)%space%follows = .true.
      end do
   end subroutine mark_corners

   !> A point whose traction is an unknown is closed.
   subroutine find_pressing(self, model, i, multiplier, presses)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      real(wp), intent(in) :: multiplier(:)    !! (nmultiplier) [stress]
      logical, intent(out) :: presses
      type(point_law_type) :: law
      real(wp) :: gap, along

      associate (g => self%enforcement(i), o => self%opposite(i))
         presses = self%facet(i) > 0 .and. .not. g%tied .and. g%method%solves_for_multiplier() &
            & .and. .not. self%mortar(self%pair(i))%is_on
         if (.not. presses) return
         call begin_point(self, model, i, multiplier, law)
         along = dot_product(law%lambda, o%normal)
         gap = o%foot%gap + law%shift + g%method%penetration(along, g%slope)
         if (g%method%updates()) gap = gap &
            & - g%method%penetration(dot_product(g%frozen, o%normal), g%slope)
         presses = along - g%c*gap > 0.0_wp
      end associate
   end subroutine find_pressing

   !> The multiplier of a point, and what is added to its gap.
   subroutine begin_point(self, model, i, multiplier, law)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      real(wp), intent(in) :: multiplier(:)    !! (nmultiplier) [stress]
      type(point_law_type), intent(inout) :: law
      integer :: d

      d = model%mesh%ndim
      law%lambda = 0.0_wp
      law%first_row = self%first_row(i)
      law%follows = law%with_tangent .and. self%follows(self%pair(i))
      if (law%first_row > 0) law%lambda(:d) = multiplier(law%first_row:law%first_row + d - 1)
      if (self%facet(i) == 0) return
      if (.not. self%anchor(i)%set) call anchor_of(self%anchor(i), self%opposite(i))
      if (self%masters%of(self%pair(i))%tool > 0) call find_sample_feet(self%opposite, &
         & self%nonlinear_points_type, i)
      law%shift = shift_of(self, i) &
         & - model%interaction(model%pair(self%pair(i))%interaction)%clearance
   end subroutine begin_point

   !> No bound of shear has slopes yet.
   pure subroutine forget_bounds(self)
      type(nonlinear_contact_type), intent(inout) :: self
      integer :: i

      do i = 1, size(self%local)
         if (allocated(self%local(i)%by_bound)) deallocate (self%local(i)%by_bound)
      end do
   end subroutine forget_bounds

   !> A point that is open whatever its slopes are: with nothing opposite, or a mortar row apart.
   logical function is_left_open(self, i, law)
      type(nonlinear_contact_type), intent(inout) :: self
      integer, intent(in) :: i
      type(point_law_type), intent(in) :: law
      integer :: d

      d = size(self%masters%x, 1)
      is_left_open = .true.
      if (self%facet(i) == 0) then
         call stay_open(self, i, d, law)
      else if (is_clear(self, i, law)) then
         call stay_clear(self, i, d, law, self%opposite(i)%normal, self%opposite(i)%foot%gap)
      else
         is_left_open = .false.
      end if
   end function is_left_open

   !> Which facet each closed point presses, for those that sit in the joint of two.
   subroutine record_facets(self)
      type(nonlinear_contact_type), intent(inout) :: self
      integer :: i

      do i = 1, self%n
         if (self%mortar(self%pair(i))%is_on .or. self%facet(i) == 0) cycle
         if (self%status(i) /= 0 .and. self%opposite(i)%ncarry > 0) &
            & call record_facet(self%masters%owner, i, self%opposite(i)%found, &
            & self%opposite(i)%kept)
      end do
   end subroutine record_facets

   !> What lies opposite all points at these displacements, and areas of slaves there.
   subroutine detect_all(self, model, u, with_tangent, error)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof) [length]
      logical, intent(in) :: with_tangent
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call forget_bounds(self)
      if (self%noted > 0.0_wp) call find_gap_path(self, model, u, error)
      if (allocated(error)) return
      call move_masters(self%masters, model, self%dofs, self%nonlinear_points_type, u, .false., &
         & self%cost, error)
      if (allocated(error)) return
      call find_closest_features(self, .false., with_tangent, error)
      if (allocated(error)) return
      do i = 1, self%n
         if (self%pair_active(self%pair(i))) then
            call detect_contact(self, model, i, .false.)
         else
            self%opposite(i)%facet = 0
         end if
         if (self%loose(i)) self%opposite(i)%facet = 0
         if (is_excluded(self, i)) self%opposite(i)%facet = 0
         self%facet(i) = self%opposite(i)%facet
      end do
      call find_growth(self, model)
      if (size(self%face) > 0) then
         if (.not. allocated(self%face_met)) then
            self%masters%start_x = self%masters%x
            self%face_met = spread(.false., 1, size(self%face))
         end if
         call find_inner_feet(self%opposite, self%masters, self%nonlinear_points_type, model, &
            & self%masters%start_x, self%face_met)
      end if
   end subroutine detect_all

   !> A row without force, with its gap and its normal.
   subroutine stay_clear(self, i, d, law, normal, gap)
      type(nonlinear_contact_type), intent(inout) :: self
      integer, intent(in) :: i, d
      type(point_law_type), intent(in) :: law
      real(wp), intent(in) :: normal(3), gap   !! gap without what is added to it [length]

      call stay_open(self, i, d, law)
      self%trial(i)%normal = normal
      self%trial(i)%gap = gap
      self%normal(:, i) = normal
      self%gap(i) = gap + shift_of(self, i)
      self%opening(i) = self%gap(i)
   end subroutine stay_clear

   !> A point with no master opposite has no traction; its multiplier is sent to zero.
   subroutine stay_open(self, i, d, law)
      type(nonlinear_contact_type), intent(inout) :: self
      integer, intent(in) :: i, d
      type(point_law_type), intent(in) :: law
      integer :: k

      self%status(i) = 0
      self%gap(i) = 0.0_wp
      ! Of a surface too far to be asked, at least so much.
      if (self%masters%of(self%pair(i))%asleep) self%gap(i) = self%masters%of(self%pair(i))%distance
      self%opening(i) = self%gap(i)
      self%pressure(i) = 0.0_wp
      self%traction(:, i) = 0.0_wp
      self%normal(:, i) = 0.0_wp
      self%xi(:, i) = 0.0_wp
      self%trial(i) = point_state_type()
      if (self%first_row(i) == 0) return
      self%row(self%first_row(i):self%first_row(i) + d - 1) = law%lambda(:d)/self%enforcement(i)%c
      if (.not. law%with_tangent) return
      self%nlocal = self%nlocal + 1
      associate (l => self%local(self%nlocal))
         l%nu = 0
         l%dof = [(self%dofs%n + self%first_row(i) + k, k=0, d - 1)]
         if (allocated(l%flat_row)) deallocate (l%flat_row)
         if (allocated(l%reach)) deallocate (l%reach)
         if (allocated(l%glue)) deallocate (l%glue)
         l%spring = reshape([real(wp) ::], [0, 0])
         l%k = reshape([(merge(1.0_wp, 0.0_wp, mod(k, d + 1) == 0), k=0, d*d - 1)], [d, d])/ &
            & self%enforcement(i)%c
      end associate
   end subroutine stay_open

   !> What a tool of which nothing is solved for bears.
   pure subroutine bear(self, model, i)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      integer :: k

      do k = 1, 6
         associate (dof => self%dofs%id(k, model%rigid_body(self%masters%of(self%pair(i))%body) &
            & %reference))
            if (dof > 0) self%force(dof) = self%force(dof) + self%trial(i)%reaction(k)
         end associate
      end do
   end subroutine bear

   !> Forces, row and results of one evaluated point; none of one without a row.
   subroutine collect(self, model, i, d, law)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i, d
      type(point_law_type), intent(in) :: law
      integer :: k

      if (self%idle(i) .or. self%waits(i)) then
         self%nlocal = self%nlocal - 1
         call stay_clear(self, i, d, law, (self%trial(i)%normal), (self%trial(i)%gap))
         return
      end if
      associate (l => self%local(self%nlocal), t => self%trial(i))
         l%point = i
         do k = 1, l%nu
            self%force(l%dof(k)) = self%force(l%dof(k)) + t%force(k)
         end do
         if (self%masters%of(self%pair(i))%body > 0) call bear(self, model, i)
         if (self%first_row(i) > 0) self%row(self%first_row(i):self%first_row(i) + d - 1) = &
            & t%row(:d)
         self%status(i) = t%status
         self%gap(i) = t%gap + shift_of(self, i)
         self%opening(i) = self%gap(i)
         if (allocated(self%opposite(i)%sample) .or. allocated(self%opposite(i)%inner)) &
            & self%opening(i) = t%opening + self%shift(i) &
            & + (1.0_wp - self%interference)*self%overclosure(i)
         self%normal(:, i) = t%normal
         self%traction(:, i) = t%traction
         self%pressure(i) = dot_product(t%traction, t%normal)
         associate (before => self%enforcement(i)%approach)
            if (any(abs(before) > 0.0_wp)) t%slip = t%slip - (before &
               & - dot_product(before, t%normal)*t%normal)
         end associate
         if (self%speed_of_trial) self%speed(i) = speed_of(self, i)
         self%xi(:, i) = self%opposite(i)%found%xi
      end associate
      ! What is open and has no multiplier couples nothing.
      if (allocated(self%opposite(i)%inner) .and. self%status(i) == 0 .and. &
         & self%first_row(i) == 0) self%nlocal = self%nlocal - 1
   end subroutine collect

   !> One augmentation would change the pressure by slope times penetration beside the compliance;
   !> the compliance of a facet, 1/(2 moduli over facet), stands for it. The slave's own: pressures
   !> of nodes that share a master facet can change without moving the master.
   subroutine estimate_softness(self)
      type(nonlinear_contact_type), intent(inout) :: self
      real(wp) :: most
      integer :: i

      most = 0.0_wp
      if (self%n > 0) most = maxval(abs(self%pressure))
      if (.not. most > 0.0_wp) return
      do i = 1, self%n
         if (self%status(i) == 0 .or. self%enforcement(i)%method%is_exact() &
            & .or. .not. self%enforcement(i)%method%reads_slope()) cycle
         self%soft_error = max(self%soft_error, abs(self%pressure(i))/most &
            & /(1.0_wp + 2.0_wp*self%enforcement(i)%slope*self%size(i)/self%slave_modulus(i)))
      end do
   end subroutine estimate_softness
end module lopin_contact_evaluation
