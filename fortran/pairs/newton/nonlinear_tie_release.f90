!> Directions in which ties on the present shape do not hold their slave nodes (lopin_tie_release).
module lopin_nonlinear_tie_release
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_constraints, only : constraints_type
   use lopin_tie_release, only : released_directions, row_misfit
   use lopin_tie_element, only : tie_type, facet_normal
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   implicit none
   private
   public :: release_nonlinear_ties

contains

   !> By the supports of the step and the rows as they were made.
   subroutine release_nonlinear_ties(self, model, constraints)
      type(nonlinear_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(constraints_type), intent(in) :: constraints
      real(wp) :: basis(model%mesh%ndim, model%mesh%ndim), misfit
      integer, allocatable :: node(:)
      real(wp), allocatable :: share(:)
      integer :: i, n, d

      d = model%mesh%ndim
      do i = 1, self%n
         associate (g => self%enforcement(i), tie => self%mortar_anchor(i)%tie)
            if (.not. g%tied) cycle
            if (tie%set) then
               node = tie%node
               share = tie%share
               call slave_first(self%node(i), node, share)
               misfit = row_misfit(self%tied_at, node, share, facet_normal(tie, self%tied_at))
            else
               call row_on_tool(self, model, i, node, share)
               misfit = 0.0_wp
            end if
            call released_directions(constraints, self%dofs, node, share, misfit, basis, n)
            g%partly = n > 0
            g%held = 0.0_wp
            g%held(:d, :d) = matmul(basis(:, n + 1:), transpose(basis(:, n + 1:)))
         end associate
      end do
   end subroutine release_nonlinear_ties

   !> A node that is glued to a tool, or to the space.
   pure subroutine row_on_tool(self, model, i, node, share)
      type(nonlinear_contact_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                 !! the point
      integer, allocatable, intent(out) :: node(:)
      real(wp), allocatable, intent(out) :: share(:)

      node = [self%node(i)]
      share = [1.0_wp]
      associate (body => self%masters%of(self%pair(i))%body)
         if (body == 0) return
         node = [node, model%rigid_body(body)%reference]
         share = [share, -1.0_wp]
      end associate
   end subroutine row_on_tool

   pure subroutine slave_first(own, node, share)
      integer, intent(in) :: own
      integer, intent(inout) :: node(:)
      real(wp), intent(inout) :: share(:)
      integer :: at

      at = findloc(node, own, dim=1)
      if (at == 0) return
      node([1, at]) = node([at, 1])
      share([1, at]) = share([at, 1])
   end subroutine slave_first
end module lopin_nonlinear_tie_release
