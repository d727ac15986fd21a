!> Detection on the present shape: the feature opposite each point, and which of two facing sides is
!> the slave.
module lopin_contact_detection
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_nonlinear_points, only : nonlinear_points_type, is_self_contact
   use lopin_closest_feature, only : find_opposite, anchor_of
   use lopin_self_contact_roles, only : choose_self_contact_roles
   use lopin_mortar_element, only : update_mortar, find_mortar_row
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   use lopin_state, only : contact_state_type
   use lopin_tie_element, only : new_tie
   implicit none
   private
   public :: find_closest_features, detect_contact, take_anchor, tie_to_facet, assign_roles, &
      & is_excluded

   !> A point farther from its master, in facets, is not tied unless ADJUST says so.
   real(wp), parameter :: too_far = 0.5_wp

contains

   !> The overlaps of the pairs by mortar.
   subroutine find_closest_features(self, start, with_slopes, error)
      type(nonlinear_contact_type), intent(inout) :: self
      logical, intent(in) :: start             !! of an increment
      logical, intent(in) :: with_slopes       !! a tangent is wanted
      type(error_type), allocatable, intent(out) :: error
      integer :: pair

      do pair = 1, size(self%mortar)
         if (.not. self%mortar(pair)%is_on) cycle
         associate (master => self%masters%of(pair)%surface)
            if (start .or. .not. allocated(master%outlook)) master%outlook = master%disc(4:6, :)
         end associate
         call update_mortar(self%mortar(pair), self%masters%rules, self%masters%of(pair)%surface, &
            & self%masters%of(pair)%tree, self%masters%x, start, with_slopes, error)
         if (allocated(error)) return
      end do
   end subroutine find_closest_features

   !> What lies opposite a point now; by mortar its row, kept as the anchor at the start.
   subroutine detect_contact(self, model, i, start)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      logical, intent(in) :: start             !! of an increment

      associate (pair => self%pair(i))
         if (.not. self%mortar(pair)%is_on) then
            if (self%mortar_anchor(i)%tie%set) return
            call find_opposite(self%opposite(i), self%masters, model, self%nonlinear_points_type, &
               & i, self%cost)
            return
         end if
         call find_mortar_row(self%mortar(pair), self%masters, i, start, self%patch(i), &
            & self%mortar_anchor(i), self%opposite(i))
      end associate
   end subroutine detect_contact

   !> The point opposite; tied points keep it, and those too far from it are never tied.
   subroutine take_anchor(self, model, i)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i

      call anchor_of(self%anchor(i), self%opposite(i))
      if (self%opposite(i)%facet > 0 .and. self%opposite(i)%foot%leans) call stand_upright(self, i)
      if (.not. self%enforcement(i)%tied) return
      self%loose(i) = .not. self%anchor(i)%set
      if (self%anchor(i)%set) self%loose(i) = abs(self%anchor(i)%gap) > max(too_far*self%size(i), &
         & model%pair(self%pair(i))%adjust)
      if (.not. self%loose(i)) call tie_to_facet(self, i, self%masters%x)
   end subroutine take_anchor

   !> A normal that leans from the way to the closest point: no slip where the increment begins,
   !> however far the point is from the surface.
   subroutine stand_upright(self, i)
      type(nonlinear_contact_type), intent(inout) :: self
      integer, intent(in) :: i
      real(wp) :: place(3), arm(3)
      integer :: d

      d = size(self%masters%x, 1)
      place = 0.0_wp
      place(:d) = self%masters%of(self%pair(i))%motion%to_tool(self%masters%x(:, self%node(i)))
      associate (foot => self%opposite(i)%foot)
         arm = place - self%anchor(i)%y
         self%anchor(i)%y = place - dot_product(arm, foot%normal)*foot%normal
      end associate
   end subroutine stand_upright

   !> A node that is glued to a facet keeps its place in the facet's frame.
   subroutine tie_to_facet(self, i, x)
      type(nonlinear_contact_type), intent(inout) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) where it was glued [length]

      associate (a => self%anchor(i), pair => self%pair(i))
         if (a%nnode == 0 .or. self%mortar(pair)%is_on) return
         call new_tie(self%mortar_anchor(i)%tie, a%node(1), [self%node(i), a%node(:a%nnode)], &
            & self%first_weight(i)*[1.0_wp, -a%share(:a%nnode)], self%first_weight(i), &
            & self%masters%of(pair)%surface%facets, self%masters%rules, x)
      end associate
   end subroutine tie_to_facet

   !> Of two sides of one surface that face each other only one presses.
   subroutine assign_roles(self, model, accepted)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(contact_state_type), intent(in) :: accepted
      integer :: pair, first, last, k

      self%pressing = 0
      do pair = 1, size(model%pair)
         if (.not. is_self_contact(model%pair(pair))) cycle
         first = findloc(self%pair, pair, dim=1)
         if (first == 0) cycle
         last = first + count(self%pair == pair) - 1
         call choose_self_contact_roles(self%masters%of(pair)%surface, self%node(first:last), &
            & self%opposite(first:last)%facet, self%size(first:last), &
            & [(any(abs(accepted%traction(:, k)) > 0.0_wp), k=first, last)], &
            & self%yields(first:last))
         do k = first, last
            if (self%opposite(k)%facet > 0 .and. .not. self%yields(k)) &
               & self%pressing(self%node(k)) = pair
         end do
      end do
   end subroutine assign_roles

   !> A point of self-contact that yields does so only to nodes that press.
   pure logical function is_excluded(self, i)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i

      is_excluded = .false.
      if (.not. self%yields(i)) return
      associate (o => self%opposite(i))
         is_excluded = any(self%pressing(o%node(:o%ncarry)) == self%pair(i))
      end associate
   end function is_excluded
end module lopin_contact_detection
