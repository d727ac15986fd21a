!> What the bodies bear of each row of contact: the sum of what it adds to the balance.
!>
!> A row whose only place is its node pushes that node by area times traction. One with places
!> beside the node, or inside its facets, pushes each along the tool's normal there: around an edge
!> of the tool those normals differ, and the sum is not area times traction.
module lopin_row_resultants
   use lopin_kinds, only : wp
   use lopin_vectors, only : cross
   use lopin_model, only : model_type
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   implicit none
   private
   public :: row_resultants, sum_places

contains

   !> Force on the slave, and its moment about the point, by row.
   subroutine row_resultants(self, model, force, couple)
      type(nonlinear_contact_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: force(:, :)     !! (3, n) [force]
      real(wp), intent(out) :: couple(:, :)    !! (3, n) [force*length]
      integer :: i, k

      couple = 0.0_wp
      do i = 1, self%n
         force(:, i) = self%weight(i)*self%traction(:, i)
      end do
      do k = 1, self%nlocal
         associate (i => self%local(k)%point)
            if (self%local(k)%nu == 0 .or. .not. has_places(self, i)) cycle
            call sum_row(self, model, k, force(:, i), couple(:, i))
         end associate
      end do
   end subroutine row_resultants

   !> The row pushes more places of its slave than the node.
   pure logical function has_places(self, i)
      type(nonlinear_contact_type), intent(in) :: self
      integer, intent(in) :: i

      has_places = self%status(i) > 0 .and. (allocated(self%opposite(i)%sample) &
         & .or. allocated(self%opposite(i)%inner))
   end function has_places

   !> Forces of a local matrix on all nodes but the reference of the tool.
   pure subroutine sum_row(self, model, local, force, couple)
      type(nonlinear_contact_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: local
      real(wp), intent(out) :: force(3), couple(3)
      integer :: reference

      associate (i => self%local(local)%point, &
         & of => self%local(local)%dof(:self%local(local)%nu))
         reference = 0
         if (self%masters%of(self%pair(i))%body > 0) reference &
            & = model%rigid_body(self%masters%of(self%pair(i))%body)%reference
         call sum_places(self%masters%x, self%dofs%node(of), self%dofs%dof(of), &
            & self%trial(i)%force(:size(of)), self%node(i), reference, force, couple)
      end associate
   end subroutine sum_row

   !> Forces on dofs of nodes and their moment about one of these; nothing of the reference.
   pure subroutine sum_places(x, node, direction, value, about, reference, force, couple)
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      integer, intent(in) :: node(:), direction(:)   !! of each dof
      real(wp), intent(in) :: value(:)         !! [force]
      integer, intent(in) :: about, reference  !! nodes; no reference: 0
      real(wp), intent(out) :: force(3), couple(3)
      real(wp) :: own(3), arm(3)
      integer :: k

      force = 0.0_wp
      couple = 0.0_wp
      do k = 1, size(node)
         if (node(k) == reference) cycle
         own = 0.0_wp
         own(direction(k)) = value(k)
         arm = 0.0_wp
         arm(:size(x, 1)) = x(:, node(k)) - x(:, about)
         force = force + own
         couple = couple + cross(arm, own)
      end do
   end subroutine sum_places
end module lopin_row_resultants
